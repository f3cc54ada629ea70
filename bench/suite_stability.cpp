/// The largest stable time step, found by bisection, beside the predicted one.

#include <cmath>
#include <random>

#include "bench/suites.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

/// One point of the map. Everything but the named parameter keeps these values.
struct Point {
  std::string varied = "alpha";
  double alpha = 0.95, E = 1.4e5, h = 0.05, J_P = 1, jitter = 0, hardening = 10, beta = 0;
  int per_edge = 2;                      ///< particles per cell edge: 1, 2, 3
  bool lone = false, estimated = false;  ///< volumes found by step 2
  double place = 0.25;                   ///< of a lone particle in its cell, along each axis [h]

  bool semi_implicit() const { return beta > 0; }
};

constexpr double perturbation = 1e-7;

/// A run is unstable if so many steps multiply the perturbation by so much: 1.5 % per step.
constexpr int steps = 600;
constexpr double burst_growth = 1e4;

/// cΔt/h up to which a limit is looked for: far beyond what accuracy allows.
constexpr double largest_tried = 16;

/// c from E, ν = 0.2, ρ = 400, hardened: c e^{ξ(1−J_P)/2}.
double sound_speed(const Point& point) {
  Material m;
  m.youngs_modulus = point.E;
  const double hardening = std::exp(point.hardening * (1 - point.J_P));
  return std::sqrt(hardening * (m.lambda_0() + 2 * m.mu_0()) / m.density);
}

/// N and N' of the cubic B-spline (Stomakhin et al. 2013, §4).
struct Spline {
  double N, slope;
};
Spline spline(double x) {
  const double d = std::abs(x), sign = x < 0 ? -1 : 1;
  if (d < 1) return {0.5 * d * d * d - d * d + 2.0 / 3, sign * (1.5 * d - 2) * d};
  return d < 2 ? Spline{std::pow(2 - d, 3) / 6, -sign * 0.5 * (2 - d) * (2 - d)} : Spline{0, 0};
}

/// A lone particle, one axis like the others: its nodes' masses are m_i = w_i m, and one step
/// multiplies an isotropic strain by 1 − z², z² = Δt² (V/m)(2μ+3λ) S/h², S = ΣN'²/N of one
/// axis; at most `growth` while z² ≤ 1 + growth. The estimate of step 2 is V = m/Σ_i(m_i w_i/h³) =
/// h³/(ΣN²)³: 8 h³ on a node, 10.3 h³ in the middle of a cell, whatever the particle's share of a
/// cell.
double lone_cfl(const Point& point, double growth) {
  double S = 0, squares = 0;
  for (int node = -1; node <= 2; ++node) {
    const Spline at = spline(point.place - node);
    squares += at.N * at.N;
    if (at.N > 0) S += at.slope * at.slope / at.N;
  }
  const double share = 1.0 / std::pow(point.per_edge, 3);                    // m/(ρ h³)
  const double volume = point.estimated ? 1 / std::pow(squares, 3) : share;  // V/h³
  Material m;
  const double modulus = m.lambda_0() + 2 * m.mu_0();
  return std::sqrt((1 + growth) * modulus * share /
                   (volume * S * (2 * m.mu_0() + 3 * m.lambda_0())));
}

/// c Δt/h up to which a step multiplies any wave by `growth` at most; 1 gives the stability
/// limit. In bulk it is where the larger root of the plane wave's characteristic polynomial
/// a² − tr a + det leaves the circle of that radius, for the worst wave number: 1.572, 1.498, 1.496
/// at α = 0, 0.95, 1 with β = 0; `largest_tried` if it never does. With N = sinc⁴(kh/2), z = ckΔtN,
/// b = βz²:
///     det = α(1−N²)(1 − z²/(1+b)) + N²/(1+b),  tr = α(1−N²) + N²/(1+b) + 1 − z²/(1+b).
double predicted_cfl(const Point& point, double growth) {
  if (point.lone) return lone_cfl(point, growth);
  double limit = largest_tried;
  for (double kh = 0.5; kh < 3.1; kh += 0.005) {
    const double half = 0.5 * kh, N = std::pow(std::sin(half) / half, 4), N2 = N * N;
    double low = 0, high = 1.01 * largest_tried;
    for (int i = 0; i < 50; ++i) {
      const double cfl = 0.5 * (low + high), z2 = std::pow(kh * N * cfl, 2);
      const double b1 = 1 + point.beta * z2;
      const double det = (point.alpha * (1 - N2) * (1 - z2 / b1) + N2 / b1) / (growth * growth);
      const double tr = (point.alpha * (1 - N2) + N2 / b1 + 1 - z2 / b1) / growth;
      // Jury's conditions for |a| ≤ growth at both roots; det = 1 at α = 1 is marginal by design.
      const bool stable = std::abs(det) <= 1 + 1e-12 && std::abs(tr) <= 1 + det + 1e-12;
      (stable ? low : high) = cfl;
    }
    limit = std::min(limit, low);
  }
  return limit;
}

Scene scene_of(const Point& point) {
  Scene scene;
  scene.name = "stability";
  scene.grid.spacing = point.h;
  // Eight spacings hold the most critical wave, 3.7 h, nearly twice.
  scene.grid.periodic = point.lone ? Vec3(Vec3::Zero()) : Vec3(point.h * Vec3(8, 4, 4));
  scene.time.end = 1e9;
  scene.time.frames_per_second = 1;
  scene.flip = point.alpha;
  Material m;
  m.name = "elastic";
  m.youngs_modulus = point.E;
  m.hardening = point.hardening;
  m.critical_compression = m.critical_stretch = std::numeric_limits<double>::infinity();
  scene.materials.push_back(m);
  if (point.semi_implicit()) {
    scene.integrator.type = IntegratorType::semi_implicit;
    scene.integrator.implicitness = point.beta;
    scene.integrator.tolerance = 1e-6;
    scene.integrator.max_iterations = 1000;
  }
  return scene;
}

/// F is perturbed, not v: a particle carries no velocity gradient.
State state_of(const Point& point, const Scene& scene, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
  State state;
  Particles& p = state.particles;
  const int n = point.per_edge;
  const double h = point.h, V = h * h * h / (n * n * n);
  const Vec3 cells = point.lone ? Vec3(1.0 / n, 1.0 / n, 1.0 / n) : Vec3(8, 4, 4);
  for (int i = 0; i < std::lround(cells[0] * n); ++i)
    for (int j = 0; j < std::lround(cells[1] * n); ++j)
      for (int k = 0; k < std::lround(cells[2] * n); ++k) {
        Vec3 x = point.lone ? Vec3(Vec3::Constant(point.place * h))
                            : Vec3(h / n * Vec3(i + 0.5, j + 0.5, k + 0.5));
        for (int axis = 0; axis < 3; ++axis) x[axis] += 0.5 * point.jitter * h / n * uniform();
        p.x.push_back(scene.wrap(x));
      }
  const std::vector<Vec3> x = p.x;
  p.resize(x.size());
  p.x = x;
  for (std::size_t at = 0; at < p.size(); ++at) {
    p.V_0[at] = point.estimated ? 0 : V;
    p.m[at] = 400 * V;
    p.id[at] = static_cast<std::int64_t>(at);
    p.F_P[at] = std::cbrt(point.J_P) * Mat3::Identity();
    for (int c = 0; c < 9; ++c) p.F_E[at](c / 3, c % 3) += perturbation * uniform();
  }
  return state;
}

bool stable(Solver& solver, Scene& scene, const State& initial, double dt) {
  if (interrupted()) throw Interrupted{};
  scene.time.step = dt;
  State state;
  try {
    solver.load(scene, initial);
    for (int step = 0; step < steps; ++step) {
      solver.step(dt);
      if (step % 50 != 49) continue;
      solver.store(state);
      for (const Mat3& F : state.particles.F_E)
        if (!((F - Mat3::Identity()).norm() < burst_growth * perturbation)) return false;
    }
  } catch (const SimulationError&) {
    return false;
  }
  return true;
}

Quantity tried(const char* outcome) {
  return {outcome, "1", "cΔt/h of a run that turned out so", Quantity::Better::neither, {}, false};
}

void plan(const Registry& registry, const Options& options, const Subject& subject,
          const Point& point, double value, bool quick, std::vector<CasePlan>& plans) {
  CasePlan plan;
  results::Case& d = plan.description;
  d.suite = "stability";
  d.name = subject.text() + "," + point.varied + "=" + to_text(value);
  d.title = "largest stable step, " + d.name;
  subject.describe(d);
  d.parameters.insert(d.parameters.end(),
                      {{"varied", point.varied},
                       {"value", value},
                       {"alpha", point.alpha},
                       {"E", point.E},
                       {"h", point.h},
                       {"J_P", point.J_P},
                       {"hardening", point.hardening},
                       {"beta", point.beta},
                       {"volumes", std::string(point.estimated ? "estimated" : "exact")},
                       {"particles_per_cell", std::pow(point.per_edge, 3)},
                       {"place", point.place},
                       {"jitter", point.jitter}});
  plan.quick = quick;
  plan.run = [=, &registry](results::Case& result) {
    Scene scene = scene_of(point);
    const State initial = state_of(point, scene, options.seed);
    const auto solver = subject.create(registry);
    const double step_of_cfl = point.h / sound_speed(point);
    double low = 0.05, high = point.semi_implicit() ? largest_tried : 3.0;
    Quantity held = tried("stable"), burst = tried("unstable");
    const auto holds = [&](double cfl) {
      const bool yes = stable(*solver, scene, initial, cfl * step_of_cfl);
      (yes ? held : burst).values.push_back(cfl);
      return yes;
    };
    if (!holds(low)) high = low, low = 0;
    const bool unlimited = point.semi_implicit() && holds(high);
    if (unlimited) low = high;
    // 3 / 2^9: half a per cent of a limit near 1.5; then on to 1 % of smaller limits.
    for (int i = 0; i < 9 || high - low > 0.01 * high; ++i) {
      if (unlimited || i == 14) break;
      const double middle = 0.5 * (low + high);
      (holds(middle) ? low : high) = middle;
    }
    result.quantities = {{"cfl",
                          "1",
                          "largest stable cΔt/h, hardened c",
                          Quantity::Better::neither,
                          {0.5 * (low + high)},
                          false},
                         {"step",
                          "s",
                          "largest stable Δt",
                          Quantity::Better::neither,
                          {0.5 * (low + high) * step_of_cfl},
                          false},
                         held,
                         burst};
    // The prediction for many is of particles that sample every wave evenly.
    if (point.lone || (point.per_edge > 1 && point.jitter == 0 && !point.estimated)) {
      const double seen = std::pow(burst_growth, 1.0 / steps);
      result.quantities.push_back({"predicted_cfl",
                                   "1",
                                   "predicted cΔt/h",
                                   Quantity::Better::neither,
                                   {predicted_cfl(point, 1)},
                                   false});
      result.quantities.push_back({"expected_cfl",
                                   "1",
                                   "cΔt/h from which the predicted growth is seen in 600 steps",
                                   Quantity::Better::neither,
                                   {predicted_cfl(point, seen)},
                                   false});
    }
    result.validation = "perturbed F by 1e-7, 600 steps, unstable where it grew 1e4-fold";
    if (unlimited) result.validation += "; no limit up to cΔt/h = " + to_text(largest_tried);
  };
  plans.push_back(std::move(plan));
}

}  // namespace

void plan_stability_suite(const Registry& registry, const Options& options,
                          std::vector<CasePlan>& plans) {
  for (const Subject& subject : subjects(registry, options, false)) {
    // Float noise is as large as the perturbation; the map is one of the method, in double.
    if (subject.precision != Precision::float64) continue;
    // The reference takes part where the recurrence predicts; elsewhere it would only be slow.
    const bool slow = subject.slow();
    const auto add = [&](const char* varied, double value, bool quick, auto set) {
      Point point;
      point.varied = varied;
      set(point);
      plan(registry, options, subject, point, value, quick && !slow, plans);
    };
    for (const double v : {0.0, 0.5, 0.8, 0.95, 1.0})
      if (!slow || v == 0 || v >= 0.95) add("alpha", v, true, [v](Point& p) { p.alpha = v; });
    // One particle with the mass of a full cell, from a node to the middle of a cell.
    for (const double v : {0.0, 0.25, 0.5})
      for (const bool estimated : {false, true}) {
        if (slow && v != 0.25) continue;
        add(estimated ? "place of a lone particle, estimated volume"
                      : "place of a lone particle, exact volume",
            v, true,
            [=](Point& p) { p.lone = true, p.per_edge = 1, p.place = v, p.estimated = estimated; });
      }
    if (slow) continue;
    for (const double v : {1.4e3, 1.4e4, 1.4e5, 1.4e6, 1.4e7})
      add("E", v, true, [v](Point& p) { p.E = v; });
    for (const double v : {1.4e3, 1.4e5, 1.4e7})
      add("E at h = 0.005", v, false, [v](Point& p) { p.E = v, p.h = 0.005; });
    for (const double v : {0.005, 0.02, 0.2}) add("h", v, true, [v](Point& p) { p.h = v; });
    for (const int v : {1, 2, 3}) {
      add("particles per cell", v * v * v, v < 3, [v](Point& p) { p.per_edge = v; });
      add("particles per cell, estimated volumes", v * v * v, v < 3, [v](Point& p) {
        p.per_edge = v;
        p.estimated = true;
        p.jitter = 1;  // as bodies are sampled
      });
    }
    for (const double v : {0.5, 0.7, 0.9}) add("J_P", v, true, [v](Point& p) { p.J_P = v; });
    for (const double v : {0.0, 5.0, 20.0})
      add("hardening at J_P = 0.8", v, true, [v](Point& p) { p.hardening = v, p.J_P = 0.8; });
    for (const double v : {0.25, 0.5, 1.0}) add("jitter", v, true, [v](Point& p) { p.jitter = v; });
    if (!subject.traits.semi_implicit) continue;
    for (const double v : {0.1, 0.25, 0.4, 0.5, 1.0})
      add("beta", v, false, [v](Point& p) { p.beta = v; });
    for (const double v : {0.1, 0.25, 0.4, 0.5, 1.0})
      add("beta at alpha = 0", v, false, [v](Point& p) { p.beta = v, p.alpha = 0; });
  }
}

}  // namespace firn::bench

// Plane waves under the semi-implicit update, for every solver.

#include <cmath>
#include <gtest/gtest.h>
#include <string>

#include "verification/semi_implicit/systems.hpp"

namespace firn::test {
namespace {

/// Small plane waves on a periodic lattice of particles, u = A a(t) sin(kX) d.
/// One time step maps the amplitudes of strain and velocity linearly; in exact
/// arithmetic and for exact quadrature any amplitude obeys
///
///     a_{n+1} = tr a_n − det a_{n−1},
///     det = α(1 − N̂²)(1 − z²/(1+b)) + N̂²/(1+b),
///     tr  = α(1 − N̂²) + N̂²/(1+b) + 1 − z²/(1+b),
///
/// with N̂ = (sin(kh/2)/(kh/2))⁴, z = c k Δt N̂, b = βz² and c the speed of the wave.
struct Wave {
  const char* name;
  Vec3 direction;  ///< of motion; waves travel along x
  double alpha, beta, cfl;
};

void PrintTo(const Wave& w, std::ostream* out) { *out << w.name; }

class ImplicitPlaneWave : public testing::TestWithParam<std::tuple<Subject, Wave>> {};

TEST_P(ImplicitPlaneWave, FollowsItsRecurrence) {
  const auto& [subject, wave] = GetParam();
  const int nodes = 16, per_axis = 2;
  Scene scene = implicit_scene(wave.beta);
  const double h = scene.grid.spacing, length = nodes * h, k = 2 * M_PI / length;
  scene.grid.periodic = Vec3(length, 4 * h, 4 * h);
  scene.flip = wave.alpha;
  scene.integrator.tolerance = 1e-9;  // nothing beside what is asserted

  const Material& material = scene.materials[0];
  const bool longitudinal = wave.direction[0] > 0;
  const double modulus = longitudinal ? material.lambda_0() + 2 * material.mu_0() : material.mu_0();
  const double c = std::sqrt(modulus / material.density), dt = wave.cfl * h / c;
  const double A = 1e-7;  // speed; strains of A/c are linear to 1e-8 and above roundoff by 1e8

  State state;
  for (int i = 0; i < nodes * per_axis; ++i)
    for (int j = 0; j < 4 * per_axis; ++j)
      for (int l = 0; l < 4 * per_axis; ++l) {
        Particles one;
        one.resize(1);
        one.x[0] = h / per_axis * (Vec3(i, j, l) + Vec3::Constant(0.5));
        one.v[0] = A * std::sin(k * one.x[0][0]) * wave.direction;
        one.V_0[0] = h * h * h / (per_axis * per_axis * per_axis);
        one.m[0] = material.density * one.V_0[0];
        state.particles.append(one);
      }
  const std::vector<Vec3> X = state.particles.x;
  const auto amplitude = [&] {
    double sum = 0;
    for (std::size_t p = 0; p < X.size(); ++p)
      sum += std::sin(k * X[p][0]) * state.particles.v[p].dot(wave.direction);
    return 2 * sum / (static_cast<double>(X.size()) * A);
  };

  const auto solver = subject.create();
  solver->load(scene, state);
  const auto next_amplitude = [&] {
    solver->step(dt);
    solver->store(state);
    return amplitude();
  };
  const double half = k * h / 2, N_hat = std::pow(std::sin(half) / half, 4), N2 = N_hat * N_hat;
  const double z = c * k * dt * N_hat, z2 = z * z / (1 + wave.beta * z * z);
  const double pic = N2 / (1 + wave.beta * z * z);
  const double det = wave.alpha * (1 - N2) * (1 - z2) + pic;
  const double tr = wave.alpha * (1 - N2) + pic + 1 - z2;

  double a_last = amplitude(), a = next_amplitude(), worst = 0;
  double expected_last = a_last, expected = a;
  EXPECT_NEAR(a_last, 1, 1e-12);  // a sum of 2048 terms
  for (int step = 0; step < 40; ++step) {
    const double expected_next = tr * expected - det * expected_last;
    expected_last = expected;
    expected = expected_next;
    a = next_amplitude();
    worst = std::max(worst, std::abs(a - expected));
  }
  // The formula takes Σ_p for an integral: 2 particles per cell leave quadrature errors of 4e-5.
  RecordProperty("largest_error", std::to_string(worst * 1e9) + "e-9");
  EXPECT_LE(worst, 1e-4);
}

const Wave waves[] = {
    {"P_flip0_beta1", Vec3::UnitX(), 0, 1, 1},
    {"P_flip50_beta50", Vec3::UnitX(), 0.5, 0.5, 1},
    {"P_flip95_beta50", Vec3::UnitX(), 0.95, 0.5, 1},
    {"P_flip95_beta1", Vec3::UnitX(), 0.95, 1, 0.2},
    {"P_flip100_beta50", Vec3::UnitX(), 1, 0.5, 1},
    {"P_flip100_beta1", Vec3::UnitX(), 1, 1, 1},
    {"S_y_flip95_beta50", Vec3::UnitY(), 0.95, 0.5, 1},
    {"S_z_flip95_beta1", Vec3::UnitZ(), 0.95, 1, 1},
};

INSTANTIATE_TEST_SUITE_P(Every, ImplicitPlaneWave,
                         testing::Combine(testing::ValuesIn(subjects()), testing::ValuesIn(waves)),
                         [](const auto& info) {
                           return text(std::get<0>(info.param)) + "_" +
                                  std::get<1>(info.param).name;
                         });

}  // namespace
}  // namespace firn::test

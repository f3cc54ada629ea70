// SPDX-License-Identifier: BSD-3-Clause
#include "verification/fuzz/random/random_scene.hpp"

#include <algorithm>
#include <limits>

#include "firn/error.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "io/scene/scene_file.hpp"
#include "verification/support/random.hpp"

namespace firn {

namespace {

/// Draws one scene. Lengths are chosen in units of h, velocities in units of h/Δt.
class Draw {
 public:
  Draw(std::uint64_t seed, const RandomOptions& options) : dice_(seed), options_(options) {
    scene_.name = "random " + std::to_string(seed);
  }

  Scene operator()() {
    grid();
    const int materials = dice_.integer(1, 2);
    for (int i = 0; i < materials; ++i) scene_.materials.push_back(material(i));
    time_and_integrator();
    scene_.flip = dice_.chance(0.3) ? dice_.integer(0, 1) : dice_.uniform(0, 1);
    // A fall of up to a hundredth of a cell each step.
    if (dice_.chance(0.7)) scene_.gravity = dice_.vector(0.01 * h_ / (dt_ * dt_));
    const int bodies = dice_.integer(1, 3);
    for (int i = 0; i < bodies; ++i) scene_.bodies.push_back(body());
    const int colliders = std::max(0, dice_.integer(-1, 4));
    for (int i = 0; i < colliders; ++i) scene_.colliders.push_back(collider());
    return scene_;
  }

 private:
  void grid() {
    h_ = scene_.grid.spacing = dice_.log_uniform(0.01, 1);
    // Far away from zero, coordinates lose digits; the bounds have to know.
    const double away = dice_.chance(0.2) ? 1000 * h_ : 10 * h_;
    if (dice_.chance(0.7)) scene_.grid.origin = dice_.vector(away);
    center_ = dice_.vector(dice_.chance(0.2) ? 100 * h_ : 4 * h_);
    for (int axis = 0; axis < 3; ++axis) {
      if (!dice_.chance(0.25)) continue;
      // Near the period's range: where things wrapped far away, turning colliders would be fast.
      scene_.grid.periodic[axis] = dice_.integer(4, 12) * h_;
      center_[axis] =
          scene_.grid.origin[axis] + dice_.uniform(-0.5, 1.5) * scene_.grid.periodic[axis];
    }
  }

  Material material(int index) {
    Material m;
    m.name = index == 0 ? "snow" : "slush";
    m.youngs_modulus = dice_.log_uniform(1e2, 1e7);
    m.poisson_ratio = dice_.chance(0.2) ? 0 : dice_.uniform(-0.3, 0.45);
    m.density = dice_.log_uniform(10, 3000);
    m.hardening = dice_.chance(0.2) ? 0 : dice_.uniform(0, 20);
    m.critical_compression = dice_.log_uniform(1e-3, 0.5);
    m.critical_stretch = dice_.log_uniform(1e-3, 0.5);
    if (dice_.chance(0.2))
      m.critical_compression = m.critical_stretch = std::numeric_limits<double>::infinity();
    return m;
  }

  /// A Courant number of the elastic wave: at most 0.3, where steps are stable until the
  /// snow hardens. Semi-implicit steps may be longer.
  void time_and_integrator() {
    double c = 0;
    for (const Material& m : scene_.materials)
      c = std::max(c, std::sqrt((m.lambda_0() + 2 * m.mu_0()) / m.density));
    IntegratorSettings& integrator = scene_.integrator;
    const bool semi_implicit = options_.semi_implicit && dice_.chance(0.25);
    double courant = dice_.log_uniform(0.01, 0.3);
    if (semi_implicit) {
      integrator.type = IntegratorType::semi_implicit;
      integrator.implicitness = dice_.chance(0.5) ? 1 : dice_.uniform(0, 1);
      integrator.tolerance = dice_.log_uniform(1e-6, 1e-3);
      integrator.max_iterations = 5000;
      courant *= 5;
    }
    dt_ = courant * h_ / c;
    TimeSettings& time = scene_.time;
    time.end = 1000 * dt_;
    time.frames_per_second = 1 / time.end;
    time.adaptive = dice_.chance(0.3);
    time.step = dt_;
    time.max_step = dt_;
    time.cfl = dice_.uniform(0.1, 0.6);
    time.elastic_cfl = courant * dice_.uniform(0.5, 1.5);
  }

  /// A point near the middle of things.
  Vec3 near(double cells) { return center_ + dice_.vector(cells * h_); }

  Vec3 direction() {
    if (dice_.chance(0.2)) return (dice_.chance(0.5) ? 1 : -1) * Vec3::Unit(dice_.integer(0, 2));
    for (;;) {
      const Vec3 d = dice_.vector(1);
      if (d.norm() > 0.1) return d;
    }
  }

  /// A solid of `cells` across, or thereabouts; a mesh known exactly if it is for a body.
  Shape shape(double low, double high, bool solid = false) {
    const Vec3 x = near(3);
    const auto size = [&] { return h_ * dice_.uniform(low, high); };
    if (!options_.mesh_file.empty() && dice_.chance(0.05)) {
      const double scale = size();
      Shape mesh = solid ? load_mesh_solid(options_.mesh_file, scale, x)
                         : load_mesh_shape(options_.mesh_file, scale, x, h_);
      (solid ? std::get<SolidShape>(mesh).source : std::get<SampledShape>(mesh).source) =
          "{ type = \"mesh\", file = \"" + options_.mesh_file + "\", scale = " + to_text(scale) +
          ", translate = [" + to_text(x[0]) + ", " + to_text(x[1]) + ", " + to_text(x[2]) + "] }";
      return mesh;
    }
    switch (dice_.integer(0, 2)) {
      case 0: return Sphere{x, size() / 2};
      case 1: {
        const double a = size(), b = size(), c = size();
        return Box{x, x + Vec3(a, b, c)};
      }
      default: {
        const Vec3 axis = direction();
        const double radius = size() / 2;
        return Cylinder{x, axis, radius, size()};
      }
    }
  }

  /// Up to `cells` of h each step.
  Vec3 velocity(double cells) {
    return dice_.chance(0.3) ? Vec3(Vec3::Zero()) : dice_.vector(cells * h_ / dt_);
  }

  Body body() {
    Body b;
    b.material = dice_.integer(0, static_cast<int>(scene_.materials.size()) - 1);
    b.shape = shape(1, 4, true);
    b.sampling = static_cast<Sampling>(dice_.integer(0, 2));  // lattice, jittered, poisson
    const int side = dice_.integer(1, 3);
    b.particles_per_cell =
        b.sampling == Sampling::lattice ? side * side * side : dice_.integer(1, 20);
    b.seed = static_cast<std::uint64_t>(dice_.integer(0, 1000000));
    if (b.sampling != Sampling::poisson && dice_.chance(0.5)) b.volumes = VolumeSource::exact;
    b.velocity = velocity(dice_.log_uniform(1e-3, 0.5));
    b.angular_velocity = velocity(dice_.log_uniform(1e-3, 0.1)) / h_;
    return b;
  }

  /// A plane near the middle, perhaps through nodes.
  HalfSpace plane() {
    HalfSpace s;
    s.normal = direction();
    s.point = near(2) - 1.5 * h_ * s.normal.normalized();
    if (dice_.chance(0.1))
      for (int axis = 0; axis < 3; ++axis)
        s.point[axis] = scene_.grid.origin[axis] +
                        h_ * std::round((s.point[axis] - scene_.grid.origin[axis]) / h_);
    return s;
  }

  Collider collider() {
    Collider c;
    c.inside = dice_.chance(0.2);
    if (dice_.chance(0.5))
      c.shape = plane();
    else
      c.shape = c.inside ? shape(4, 10) : shape(0.5, 5);
    c.sticky = dice_.chance(0.25);
    if (!c.sticky) c.friction = dice_.chance(0.3) ? 0 : dice_.log_uniform(0.01, 3);
    if (dice_.chance(0.5)) c.velocity = velocity(dice_.log_uniform(1e-3, 0.3));
    if (dice_.chance(0.4)) c.angular_velocity = velocity(dice_.log_uniform(1e-3, 0.1)) / h_;
    c.center = dice_.chance(0.7) ? center(c.shape) : near(3);
    return c;
  }

  fixtures::Dice dice_;
  const RandomOptions& options_;
  Scene scene_;
  double h_ = 1, dt_ = 1;
  Vec3 center_ = Vec3::Zero();  ///< where everything is
};

}  // namespace

Scene through_toml(const Scene& scene, std::int64_t max_particles) {
  SceneOptions options;
  options.max_particles = 8 * max_particles;  // counted in bounding boxes
  Scene read = parse_scene(resolved_toml(scene), "random.toml", {}, options);
  const auto particles = static_cast<std::int64_t>(sample_bodies(read).size());
  if (particles > max_particles)
    throw InputError("random.toml", "particles", std::to_string(particles),
                     "at most " + std::to_string(max_particles));
  return read;
}

RandomCase random_case(std::uint64_t seed, const RandomOptions& options) {
  // What the reader refuses (a body wider than a period, or without a particle) is drawn anew.
  for (std::int64_t attempt = 0;; ++attempt) {
    fixtures::Dice dice(hash_words(seed, {attempt, 1}));
    RandomCase c;
    c.start_step = dice.chance(0.4) ? 0 : static_cast<std::int64_t>(dice.log_uniform(1, 60));
    c.steps = dice.integer(1, 4);
    try {
      c.scene = Draw(hash_words(seed, {attempt, 2}), options)();
      c.scene.name = "random " + std::to_string(seed);
      c.scene = through_toml(c.scene, options.max_particles);
      return c;
    } catch (const InputError&) {
      if (attempt >= 1000) throw;  // not a matter of chance any more
    }
  }
}

}  // namespace firn

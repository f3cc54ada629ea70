#pragma once
/// Scenes and states for the tests of files: small, with no two numbers equal.

#include <filesystem>
#include <string>

#include "firn/scene.hpp"

namespace firn::testing {

/// x rounded to float. Through memory: g++ 12.2 from -O2 on drops the two
/// conversions when it packs neighbouring ones together (SLP).
inline double through_float(double x) {
  const volatile float rounded = static_cast<float>(x);
  return static_cast<double>(rounded);
}

inline Particles through_float(Particles p) {
  const auto round = [](auto& array) {
    for (auto& value : array)
      for (double* x = value.data(); x != value.data() + value.size(); ++x) *x = through_float(*x);
  };
  round(p.x);
  round(p.v);
  round(p.F_E);
  round(p.F_P);
  for (double& m : p.m) m = through_float(m);
  for (double& V : p.V_0) V = through_float(V);
  return p;
}

/// `n` particles with ids in falling order.
inline Particles odd_particles(int n) {
  Particles p;
  p.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double s = 1.0 / (3 + i);
    p.x[k] = Vec3(s, 0.1 + s, 1 - s);
    p.v[k] = Vec3(-s, 1.0 / (7 + i), 0.3 * i);
    p.m[k] = 0.01 + s;
    p.V_0[k] = i % 3 == 0 ? 0 : s * s;
    for (int c = 0; c < 9; ++c) {
      p.F_E[k](c / 3, c % 3) += 1e-2 / (11 + 9 * i + c);
      p.F_P[k](c / 3, c % 3) -= 1e-2 / (17 + 9 * i + c);
    }
    p.id[k] = n - 1 - i;
    p.material[k] = i % 2;
  }
  return p;
}

/// Fixed Δt = 1 ms, a frame every 4 steps, end after 0.02 s.
inline Scene tiny_scene(int particles = 5) {
  Scene scene;
  scene.name = "tiny";
  scene.gravity = Vec3(0, 0.5, -9.81);
  scene.grid.spacing = 0.1;
  scene.time.end = 0.02;
  scene.time.step = 1e-3;
  scene.time.frames_per_second = 250;
  scene.materials.resize(2);
  Body body;
  body.sampling = Sampling::from_file;
  body.particles = odd_particles(particles);
  scene.bodies.push_back(body);
  scene.toml = "name = \"tiny\"  # ‖v‖\n";
  return scene;
}

/// The same with Δt ≤ 1 ms that shrinks as the particles become faster.
inline Scene adaptive_scene(int particles = 5) {
  Scene scene = tiny_scene(particles);
  scene.time.adaptive = true;
  scene.time.max_step = 1e-3;
  scene.time.cfl = 0.0123;
  scene.toml = "name = \"tiny and adaptive\"\n";
  return scene;
}

/// A fresh folder, removed with everything in it at the end of the test. In
/// memory if `in_memory` and the system has such a place: fsync() costs nothing
/// there.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(bool in_memory = false) {
    const std::filesystem::path shm = "/dev/shm";
    const bool use_shm = in_memory && std::filesystem::is_directory(shm);
    std::string name =
        ((use_shm ? shm : std::filesystem::temp_directory_path()) / "firn-io-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace firn::testing

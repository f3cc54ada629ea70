// SPDX-License-Identifier: BSD-3-Clause
/// What is not trusted, in a process of its own. It answers questions on file
/// descriptor 3 until that is closed.
///
///     firn-guest LIBRARY double|float THREADS   the guest's shared library lives here
///     firn-guest --read FILE PARTICLES          reads the trajectory that a guest wrote

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <limits>
#include <memory>
#include <string>

#include "firn/error.hpp"
#include "firn/firn_guest.h"
#include "firn/scene.hpp"
#include "guests/packet.hpp"
#include "io/scene/scene_file.hpp"
#include "io/trajectory/reader.hpp"

namespace firn::guest {

namespace {

constexpr int channel = 3;

/// The scene as the guest sees it; lives as long as the scene is loaded.
class GuestScene {
 public:
  explicit GuestScene(Scene scene) : scene_(std::move(scene)) {
    for (const Material& m : scene_.materials)
      materials_.push_back({m.youngs_modulus, m.poisson_ratio, m.density, m.hardening,
                            m.critical_compression, m.critical_stretch});
    for (const Collider& c : scene_.colliders)
      colliders_.push_back({c.friction, c.sticky ? 1 : 0, c.moves() ? 1 : 0});
    view_.struct_size = sizeof view_;
    view_.spacing = scene_.grid.spacing;
    for (int axis = 0; axis < 3; ++axis) {
      view_.origin[axis] = scene_.grid.origin[axis];
      view_.periodic[axis] = scene_.grid.periodic[axis];
      view_.gravity[axis] = scene_.gravity[axis];
    }
    view_.flip = scene_.flip;
    view_.semi_implicit = scene_.semi_implicit() ? 1 : 0;
    view_.implicitness = scene_.integrator.implicitness;
    view_.tolerance = scene_.integrator.tolerance;
    view_.max_iterations = scene_.integrator.max_iterations;
    view_.material_count = materials_.size();
    view_.materials = materials_.data();
    view_.collider_count = colliders_.size();
    view_.colliders = colliders_.data();
    view_.contact = &GuestScene::contact;
    view_.host = this;
    view_.toml = scene_.toml.c_str();
    view_.step = scene_.time.adaptive ? 0 : scene_.time.step;
    view_.max_step = scene_.time.max_step;
    view_.cfl = scene_.time.cfl;
    view_.elastic_cfl = scene_.time.elastic_cfl;
  }
  GuestScene(const GuestScene&) = delete;
  GuestScene& operator=(const GuestScene&) = delete;

  const firn_guest_scene* view() const { return &view_; }

 private:
  static void contact(void* host, size_t index, const double x[3], double t,
                      firn_guest_contact* result) {
    const GuestScene& self = *static_cast<const GuestScene*>(host);
    if (index >= self.scene_.colliders.size()) {
      std::fprintf(stderr, "guest asked for collider %zu of %zu\n", index,
                   self.scene_.colliders.size());
      std::abort();
    }
    const Contact c = self.scene_.colliders[index].contact(Vec3(x[0], x[1], x[2]), t);
    result->phi = c.phi;
    for (int axis = 0; axis < 3; ++axis) {
      result->normal[axis] = c.normal[axis];
      result->velocity[axis] = c.velocity[axis];
    }
  }

  Scene scene_;
  std::vector<firn_guest_material> materials_;
  std::vector<firn_guest_collider> colliders_;
  firn_guest_scene view_ = {};
};

double* numbers(std::vector<double>& values) { return values.empty() ? nullptr : values.data(); }

template <class Matrix>
double* numbers(std::vector<Matrix>& values) {
  return values.empty() ? nullptr : values.front().data();
}

/// The C view of a state. Eigen keeps matrices column by column, the ABI wants
/// rows: transposed() before and after.
firn_guest_state view_of(State& s) {
  firn_guest_state view = {};
  view.struct_size = sizeof view;
  view.time = s.time;
  view.dt = s.dt;
  view.step = s.step;
  view.next_stage = number(s.next);
  Particles& p = s.particles;
  view.particle_count = p.size();
  view.x = numbers(p.x);
  view.v = numbers(p.v);
  view.m = numbers(p.m);
  view.V_0 = numbers(p.V_0);
  view.F_E = numbers(p.F_E);
  view.F_P = numbers(p.F_P);
  view.id = p.id.data();
  view.material = p.material.data();
  Grid& g = s.grid;
  view.node_count = g.size();
  view.node = g.node.empty() ? nullptr : &g.node.front().i;
  view.node_m = numbers(g.m);
  view.node_v = numbers(g.v);
  view.node_f = numbers(g.f);
  view.node_v_star = numbers(g.v_star);
  view.free_directions = numbers(g.free_directions);
  view.node_v_new = numbers(g.v_new);
  return view;
}

void transpose(State& s) {
  for (auto* matrices : {&s.particles.F_E, &s.particles.F_P, &s.grid.free_directions})
    for (Mat3& matrix : *matrices) matrix.transposeInPlace();
}

/// A state of the announced sizes in which every number is NaN: what the guest
/// does not fill is seen at once.
State poisoned(const State& loaded, std::size_t nodes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  State s;
  s.particles.resize(loaded.particles.size());
  s.grid.node.resize(nodes);
  const auto poison = [nan](std::size_t n) {
    return [n, nan]<class T>(const char*, std::vector<T>& array) {
      if constexpr (std::is_same_v<T, double>)
        array.assign(n, nan);
      else if constexpr (!std::is_integral_v<T>)
        array.assign(n, T::Constant(nan));
    };
  };
  for_each_field(poison(s.particles.size()), s.particles);
  for_each_field(poison(nodes), s.grid);
  s.particles.id = loaded.particles.id;
  s.particles.material = loaded.particles.material;
  return s;
}

/// Arrays that no stage so far has written are dropped; between steps, the whole grid.
void keep_written(State& s, bool semi_implicit) {
  const int done = number(s.next) - 1;
  if (done < number(Stage::rasterize)) s.grid.clear();
  if (done < number(Stage::grid_forces)) s.grid.f.clear();
  if (done < number(Stage::grid_velocities)) s.grid.v_star.clear();
  if (done < number(Stage::grid_collisions) || !semi_implicit) s.grid.free_directions.clear();
  if (done < number(Stage::integration)) s.grid.v_new.clear();
}

class Runner {
 public:
  Runner(const firn_guest_solver* table, bool float_precision, int threads)
      : table_(table), self_(table->create(float_precision ? 1 : 0, threads)) {
    if (self_ == nullptr) throw std::runtime_error("create() failed");
  }
  ~Runner() { table_->destroy(self_); }
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  Packet answer(Packet& question) {
    switch (question.kind) {
      case Kind::traits: return traits();
      case Kind::load: return load(question);
      case Kind::choose_time_step: return choose_time_step();
      case Kind::advance: return advance(question);
      case Kind::store: return store();
      case Kind::answer:
      case Kind::failure: break;
    }
    throw std::runtime_error("a question of unknown kind");
  }

 private:
  void require(int status, const char* function) const {
    if (status == 0) return;
    const char* reason = table_->last_error(self_);
    throw std::runtime_error(std::string(function) +
                             "() failed: " + (reason ? reason : "no reason given"));
  }

  Packet traits() const {
    Packet packet(Kind::answer);
    packet.put(std::string(table_->name ? table_->name : "unnamed"));
    packet.put(table_->supports_float);
    packet.put(table_->supports_semi_implicit);
    packet.put(static_cast<std::int32_t>(table_->choose_time_step != nullptr));
    packet.put_all(std::vector<std::int32_t>(table_->stops, table_->stops + table_->stop_count));
    return packet;
  }

  Packet load(Packet& question) {
    const std::string toml = question.get_text();
    state_ = get_state(question);
    // `check` loads the same scene before every stage, and a mesh takes long to read.
    if (!scene_ || toml != scene_->view()->toml) {
      SceneOptions options;
      options.needs_bodies = false;  // a state comes with it
      scene_ = std::make_unique<GuestScene>(parse_scene(toml, "scene", ".", options));
    }
    transpose(state_);
    const firn_guest_state view = view_of(state_);
    require(table_->load(self_, scene_->view(), &view), "load");
    return Packet(Kind::answer);
  }

  Packet choose_time_step() const {
    double dt = 0;
    require(table_->choose_time_step(self_, &dt), "choose_time_step");
    Packet packet(Kind::answer);
    packet.put(dt);
    return packet;
  }

  Packet advance(Packet& question) const {
    const auto last = question.get<std::int32_t>();
    const auto dt = question.get<double>();
    firn_guest_report report = {};
    require(table_->advance_through(self_, last, dt, &report), "advance_through");
    Packet packet(Kind::answer);
    packet.put(report.grid_nodes);
    packet.put(report.solver_iterations);
    packet.put(report.solver_residual);
    packet.put(report.solver_indefinite);
    return packet;
  }

  Packet store() const {
    size_t nodes = 0;
    require(table_->node_count(self_, &nodes), "node_count");
    // 64 nodes a particle is what the cubic kernel reaches.
    if (nodes > 64 * state_.particles.size() + 64)
      throw std::runtime_error("node_count() says " + std::to_string(nodes) +
                               "; at most 64 per particle are possible");
    State stored = poisoned(state_, nodes);
    firn_guest_state view = view_of(stored);
    view.next_stage = 0;
    require(table_->store(self_, &view), "store");
    stored.time = view.time;
    stored.dt = view.dt;
    stored.step = view.step;
    if (view.next_stage < 1 || view.next_stage > stage_count)
      throw std::runtime_error("store() left next_stage at " + std::to_string(view.next_stage));
    stored.next = static_cast<Stage>(view.next_stage);
    transpose(stored);
    keep_written(stored, scene_->view()->semi_implicit != 0);
    Packet packet(Kind::answer);
    put_state(packet, stored);
    return packet;
  }

  const firn_guest_solver* table_;
  void* self_;
  std::unique_ptr<GuestScene> scene_;
  State state_;  ///< as loaded
};

const firn_guest_solver* open_library(const char* path) {
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw std::runtime_error(dlerror());
  void* symbol = dlsym(library, FIRN_GUEST_ENTRY_NAME);
  if (symbol == nullptr) throw std::runtime_error("it does not export " FIRN_GUEST_ENTRY_NAME "()");
  const auto* table = reinterpret_cast<firn_guest_entry_function>(symbol)();
  if (table == nullptr) throw std::runtime_error(FIRN_GUEST_ENTRY_NAME "() returned NULL");
  if (table->abi_version != FIRN_GUEST_ABI_VERSION)
    throw std::runtime_error("it was built for version " + std::to_string(table->abi_version) +
                             " of the ABI, this is version " +
                             std::to_string(FIRN_GUEST_ABI_VERSION));
  if (table->struct_size != sizeof(firn_guest_solver))
    throw std::runtime_error("its struct_size is " + std::to_string(table->struct_size) +
                             ", this version's is " + std::to_string(sizeof(firn_guest_solver)));
  if (!table->create || !table->destroy || !table->last_error || !table->load ||
      !table->advance_through || !table->node_count || !table->store || !table->stops)
    throw std::runtime_error("a required function of its table is NULL");
  return table;
}

/// The channel stays open for as long as Firn wants: no deadline on this side.
Clock::time_point forever() { return Clock::now() + std::chrono::hours(24 * 365); }

/// Answers every question by `answer`, an exception by its text.
template <class Answer>
[[noreturn]] void serve(Answer answer) {
  constexpr std::uint64_t anything = std::uint64_t{1} << 40;  // Firn's own words are trusted
  for (;;) {
    Packet question = receive(channel, forever(), anything);
    Packet reply(Kind::failure);
    try {
      reply = answer(question);
    } catch (const std::exception& error) {
      reply.put(std::string(error.what()));
    }
    send(channel, reply, forever());
  }
}

[[noreturn]] void serve_library(const char* library, bool float_precision, int threads) {
  std::unique_ptr<Runner> runner;
  serve([&](Packet& question) {
    if (!runner) runner = std::make_unique<Runner>(open_library(library), float_precision, threads);
    return runner->answer(question);
  });
}

[[noreturn]] void serve_trajectory(const char* path, std::size_t particles) {
  serve([&](Packet&) {
    const TrajectoryReader reader(path);
    const std::int64_t last = reader.frames() - 1;
    if (last < 0) throw std::runtime_error("it contains no frame");
    if (static_cast<std::size_t>(reader.particles(last)) != particles)
      throw std::runtime_error(std::to_string(reader.particles(last)) + " particles instead of " +
                               std::to_string(particles));
    Packet packet(Kind::answer);
    put_state(packet, reader.read_frame_unchecked(last));
    return packet;
  });
}

}  // namespace

}  // namespace firn::guest

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "firn-guest is started by firn: firn check SCENE --solver ./LIBRARY.so\n");
    return 2;
  }
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // what the guest prints is not lost when it crashes
  try {
    const std::string first = argv[1], second = argv[2];
    if (first == "--read")
      firn::guest::serve_trajectory(argv[2], std::strtoull(argv[3], nullptr, 10));
    firn::guest::serve_library(argv[1], second == "float", std::atoi(argv[3]));
  } catch (const firn::guest::ChannelError& error) {
    return error.reason == firn::guest::ChannelError::Reason::closed ? 0 : 3;
  }
}

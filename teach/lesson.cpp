// SPDX-License-Identifier: BSD-3-Clause
#include "teach/lesson.hpp"

#include <algorithm>
#include <utility>

#include "firn/error.hpp"
#include "reference/reference_solver.hpp"
#include "reference/stencil.hpp"
#include "teach/choose.hpp"

namespace firn::teach {

namespace {

StepRecord record_step(const Scene& scene, const State& start) {
  const auto solver = make_reference_solver({});
  solver->load(scene, start);
  StepRecord record;
  record.time_step = solver->choose_time_step();
  record.after[0] = start;
  for (const Stage stage : all_stages) {
    record.report = solver->advance_through(stage, record.time_step.dt);
    solver->store(record.after[static_cast<std::size_t>(number(stage))]);
  }
  record.events = events_of(record);
  return record;
}

/// Particle-steps that the search for a step worth showing may cost: some five
/// seconds of the reference. A scene in which nothing happens by then is shown
/// as far as it came.
constexpr double search_budget = 1.2e6;

struct Found {
  State start;
  std::string why;
};

Found given_step(const Scene& scene, const State& initial, std::int64_t step) {
  if (step < 0) throw InputError("--step", "step to show", std::to_string(step), "at least 0");
  const auto solver = make_reference_solver({});
  solver->load(scene, initial);
  for (std::int64_t n = 0; n < step; ++n) solver->step(solver->choose_time_step().dt);
  Found found{initial, "It was chosen with --step."};
  solver->store(found.start);
  return found;
}

/// Enough of the particles to see where snow yields and where it does not.
constexpr double worthwhile_share = 0.25;

/// Number of kinds of events, then the share of particles that yield, up to the above.
std::pair<int, double> interest(const StepEvents& events, double particles) {
  const double share = static_cast<double>(events.particles_yielding) / particles;
  return {events.kinds(), std::min(share, worthwhile_share)};
}

/// The first step of the greatest interest.
Found interesting_step(const Scene& scene, const State& initial) {
  const double particles = static_cast<double>(std::max<std::size_t>(initial.particles.size(), 1));
  const auto most = static_cast<std::int64_t>(search_budget / particles) + 1;
  Found best{initial, ""};
  StepEvents best_events;
  State state = initial;
  for (std::int64_t n = 0; n < most; ++n) {
    if (n > 0 && state.time >= scene.time.end) break;
    StepRecord record;
    try {
      record = record_step(scene, state);
    } catch (const SimulationError&) {
      if (n == 0) throw;
      break;
    }
    if (interest(record.events, particles) > interest(best_events, particles)) {
      best_events = record.events;
      best.start = state;
    }
    state = std::move(record.after.back());
    state.grid.clear();
  }
  best.why = best_events.kinds() == 0
                 ? "None of the steps that were searched has contact or yielding."
                 : "It is the first of the steps searched in which most kinds of events coincide "
                   "(nodes in "
                   "contact, snow that yields, particles in contact) and many particles yield.";
  return best;
}

Decomposition decompose(const Scene& scene, const StepRecord& record, std::size_t p,
                        std::vector<StencilNode>& stencil) {
  const State& before = record.before(Stage::deformation);
  const Grid& grid = before.grid;
  std::vector<NodeIndex> node;
  reference::Stencils stencils;
  stencils.build(scene, record.after[0].particles, Stage::rasterize, node);
  Decomposition d;
  d.grad_v_p = Mat3::Zero();
  stencils.for_each_node_with_gradient(p, [&](std::size_t i, double w_ip, const Vec3& grad_w_ip) {
    // The stored grid has no nodes of zero mass; their velocity is 0.
    const auto place = std::lower_bound(grid.node.begin(), grid.node.end(), node[i]);
    const bool stored = place != grid.node.end() && *place == node[i];
    const auto at = static_cast<std::size_t>(place - grid.node.begin());
    d.grad_v_p += (stored ? grid.v_new[at] : Vec3::Zero()) * grad_w_ip.transpose();
    if (stored) stencil.push_back({at, w_ip, grad_w_ip});
  });
  d.F_E_hat = (Mat3::Identity() + record.time_step.dt * d.grad_v_p) * before.particles.F_E[p];
  d.usv = reference::svd(d.F_E_hat);
  d.polar = reference::polar(d.usv);
  return d;
}

/// Some steps of Δt with the integrator that `scene` names; what went wrong, if anything.
std::string try_steps(const Scene& scene, const State& start, double dt, int steps,
                      StepReport& first_step, Diagnostics& result) {
  const auto solver = make_reference_solver({});
  solver->load(scene, start);
  try {
    for (int n = 0; n < steps; ++n) {
      const StepReport report = solver->step(dt);
      if (n == 0) first_step = report;
    }
  } catch (const SimulationError& error) {
    return error.what();
  }
  result = solver->diagnostics(scene);
  return "";
}

std::vector<ImplicitTrial> implicit_trials(const Scene& scene, const StepRecord& record) {
  Scene semi_implicit = scene, explicit_euler = scene;
  explicit_euler.integrator.type = IntegratorType::explicit_euler;
  semi_implicit.integrator.type = IntegratorType::semi_implicit;
  if (!scene.semi_implicit()) semi_implicit.integrator.implicitness = 1;
  const State& start = record.after[0];
  // Forty steps of a small scene take a second or two; of a large one, fewer have to do.
  const int span = static_cast<int>(std::clamp<std::size_t>(40000 / start.particles.size(), 1, 40));
  std::vector<ImplicitTrial> trials;
  for (const int multiple : {1, 5, 10, 20, 40}) {
    ImplicitTrial t;
    t.multiple = multiple;
    t.dt = multiple * record.time_step.dt;
    t.steps = std::max(1, span / multiple);
    StepReport unused;
    t.semi_implicit_error =
        try_steps(semi_implicit, start, t.dt, t.steps, t.first_step, t.semi_implicit);
    t.explicit_error = try_steps(explicit_euler, start, t.dt, t.steps, unused, t.explicit_euler);
    trials.push_back(std::move(t));
  }
  return trials;
}

}  // namespace

Lesson make_lesson(const Scene& scene, const LessonOptions& options) {
  Lesson lesson;
  lesson.scene = scene;
  const State initial = initial_state(scene);
  if (initial.particles.size() == 0)
    throw InputError(scene.name, "number of particles", "0", "at least 1 to teach with");
  Found found =
      options.step ? given_step(scene, initial, *options.step) : interesting_step(scene, initial);
  found.start.grid.clear();
  lesson.why_step = found.why;
  lesson.record = record_step(scene, found.start);
  lesson.first = record_step(scene, initial);

  const auto solver = make_reference_solver({});
  State between = found.start;
  solver->load(scene, between);
  lesson.before = solver->diagnostics(scene);
  between = lesson.record.after.back();
  solver->load(scene, between);
  lesson.after = solver->diagnostics(scene);

  const Choice particle = options.particle ? given_particle(lesson.record, *options.particle)
                                           : choose_particle(scene, lesson.record);
  lesson.particle = particle.index;
  lesson.why_particle = particle.why;
  lesson.decomposition = decompose(scene, lesson.record, lesson.particle, lesson.stencil);
  const Choice node = options.node ? given_node(lesson.record, *options.node)
                                   : choose_node(lesson.record, lesson.stencil);
  lesson.node = node.index;
  lesson.why_node = node.why;
  lesson.implicit_trials = implicit_trials(scene, lesson.record);
  return lesson;
}

}  // namespace firn::teach

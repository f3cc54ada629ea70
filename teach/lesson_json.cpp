// SPDX-License-Identifier: BSD-3-Clause
#include "teach/lesson_json.hpp"

#include <cmath>
#include <string>

#include "teach/sources.hpp"

namespace firn::teach {

namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity: an unlimited θ becomes the text "inf", as in scene files.
Json value(double x) {
  if (std::isfinite(x)) return x;
  return std::isnan(x) ? "nan" : x > 0 ? "inf" : "-inf";
}
Json value(const Vec3& v) { return {value(v[0]), value(v[1]), value(v[2])}; }
Json value(const Mat3& M) {
  Json rows = Json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({value(M(r, 0)), value(M(r, 1)), value(M(r, 2))});
  return rows;
}

template <class T>
Json values(const std::vector<T>& from) {
  Json list = Json::array();
  for (const T& x : from) list.push_back(value(x));
  return list;
}

Json field(const State& state, Field which) {
  return visit_field(state, which, [](const auto& array) { return values(array); });
}

Json particles_json(const State& state) {
  const Particles& p = state.particles;
  return {{"id", p.id},           {"material", p.material}, {"m", values(p.m)},
          {"x_p", values(p.x)},   {"v_p", values(p.v)},     {"V_p0", values(p.V_0)},
          {"F_E", values(p.F_E)}, {"F_P", values(p.F_P)}};
}

/// The particles before the step, the nodes, and for each stage the fields it writes.
Json record_json(const StepRecord& record) {
  Json json;
  json["step"] = record.after[0].step;
  json["time"] = record.after[0].time;
  json["dt"] = record.time_step.dt;
  json["dt_bound"] = std::string(name(record.time_step.bound));
  json["before"] = particles_json(record.after[0]);
  Json nodes = Json::array();
  for (const NodeIndex& n : record.behind(Stage::rasterize).grid.node)
    nodes.push_back({n.i, n.j, n.k});
  json["nodes"] = nodes;
  for (const Stage stage : all_stages) {
    Json written;
    for (const Field f : fields_written(stage))
      written[std::string(name(f))] = field(record.behind(stage), f);
    json["stages"][std::string(name(stage))] = written;
  }
  json["events"] = {{"nodes_in_contact", record.events.nodes_in_contact},
                    {"particles_yielding", record.events.particles_yielding},
                    {"particles_in_contact", record.events.particles_in_contact}};
  return json;
}

Json diagnostics_json(const Diagnostics& d) {
  return {{"mass", value(d.mass)},
          {"momentum", value(d.momentum)},
          {"angular_momentum", value(d.angular_momentum)},
          {"kinetic_energy", value(d.kinetic_energy)},
          {"elastic_energy", value(d.elastic_energy)},
          {"gravitational_energy", value(d.gravitational_energy)},
          {"center_of_mass", value(d.center_of_mass)},
          {"max_speed", value(d.max_speed)},
          {"min_J_E", value(d.min_J_E)},
          {"max_J_E", value(d.max_J_E)}};
}

Json scene_json(const Scene& scene) {
  Json json;
  json["name"] = scene.name;
  json["toml"] = scene.toml;
  json["gravity"] = value(scene.gravity);
  json["h"] = scene.grid.spacing;
  json["origin"] = value(scene.grid.origin);
  json["period_nodes"] = {scene.grid.period_nodes(0), scene.grid.period_nodes(1),
                          scene.grid.period_nodes(2)};
  json["alpha"] = scene.flip;
  json["semi_implicit"] = scene.semi_implicit();
  json["beta"] = scene.integrator.implicitness;
  json["tolerance"] = scene.integrator.tolerance;
  for (const Material& m : scene.materials)
    json["materials"].push_back({{"name", m.name},
                                 {"youngs_modulus", m.youngs_modulus},
                                 {"poisson_ratio", m.poisson_ratio},
                                 {"density", m.density},
                                 {"hardening", m.hardening},
                                 {"critical_compression", value(m.critical_compression)},
                                 {"critical_stretch", value(m.critical_stretch)},
                                 {"mu_0", m.mu_0()},
                                 {"lambda_0", m.lambda_0()}});
  json["colliders"] = scene.colliders.size();
  return json;
}

/// φ, n and v_co of every collider at the chosen node and particle, at tⁿ.
Json contacts_json(const Lesson& lesson) {
  const State& start = lesson.record.after[0];
  const NodeIndex& n = lesson.record.behind(Stage::rasterize).grid.node[lesson.node];
  const Vec3 x_i = lesson.scene.grid.origin + lesson.scene.grid.spacing * Vec3(n.i, n.j, n.k);
  const auto at = [&](const Vec3& x) {
    Json list = Json::array();
    for (const Collider& collider : lesson.scene.colliders) {
      const Contact c = collider.contact(x, start.time);
      list.push_back({{"phi", c.phi},
                      {"normal", value(c.normal)},
                      {"velocity", value(c.velocity)},
                      {"friction", collider.friction},
                      {"sticky", collider.sticky}});
    }
    return list;
  };
  // For the picture: φ ≤ 0 at every node.
  Json solid = Json::array();
  for (const NodeIndex& m : lesson.record.behind(Stage::rasterize).grid.node) {
    const Vec3 x = lesson.scene.grid.origin + lesson.scene.grid.spacing * Vec3(m.i, m.j, m.k);
    bool inside = false;
    for (const Collider& collider : lesson.scene.colliders)
      inside |= collider.phi(x, start.time) <= 0;
    solid.push_back(inside ? 1 : 0);
  }
  return {{"node", at(x_i)},
          {"particle", at(start.particles.x[lesson.particle])},
          {"nodes_in_solid", solid}};
}

Json trial_json(const ImplicitTrial& t) {
  return {{"multiple", t.multiple},
          {"dt", t.dt},
          {"steps", t.steps},
          {"iterations", t.first_step.solver_iterations},
          {"residual", value(t.first_step.solver_residual)},
          {"indefinite", t.first_step.solver_indefinite},
          {"semi_implicit", diagnostics_json(t.semi_implicit)},
          {"explicit", diagnostics_json(t.explicit_euler)},
          {"semi_implicit_error", t.semi_implicit_error},
          {"explicit_error", t.explicit_error}};
}

}  // namespace

Json to_json(const Lesson& lesson) {
  Json json;
  json["format"] = "firn-lesson";
  json["version"] = 1;
  json["scene"] = scene_json(lesson.scene);
  json["particle"] = lesson.particle;
  json["node"] = lesson.node;
  json["why"] = {
      {"step", lesson.why_step}, {"particle", lesson.why_particle}, {"node", lesson.why_node}};
  json["record"] = record_json(lesson.record);
  Json first = record_json(lesson.first);
  first["stages"] = {{"rasterize", first["stages"]["rasterize"]},
                     {"volumes", first["stages"]["volumes"]}};
  json["first"] = first;
  json["diagnostics"] = {{"before", diagnostics_json(lesson.before)},
                         {"after", diagnostics_json(lesson.after)}};
  for (const StencilNode& n : lesson.stencil)
    json["stencil"].push_back(
        {{"node", n.node}, {"w_ip", n.w_ip}, {"grad_w_ip", value(n.grad_w_ip)}});
  const Decomposition& d = lesson.decomposition;
  json["decomposition"] = {{"grad_v_p", value(d.grad_v_p)}, {"F_E_hat", value(d.F_E_hat)},
                           {"U", value(d.usv.U)},           {"sigma", value(d.usv.sigma)},
                           {"V", value(d.usv.V)},           {"R", value(d.polar.R)},
                           {"S", value(d.polar.S)}};
  json["contacts"] = contacts_json(lesson);
  for (const ImplicitTrial& t : lesson.implicit_trials)
    json["implicit_trials"].push_back(trial_json(t));
  for (const SourceFile& file : reference_sources())
    json["sources"][std::string(file.path)] = std::string(file.text);
  return json;
}

}  // namespace firn::teach

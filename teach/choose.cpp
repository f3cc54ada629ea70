// SPDX-License-Identifier: BSD-3-Clause
#include "teach/choose.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "firn/error.hpp"
#include "reference/stencil.hpp"

namespace firn::teach {

namespace {

bool in_contact(const StepRecord& record, std::size_t i) {
  return record.behind(Stage::grid_velocities).grid.v_star[i] !=
         record.behind(Stage::grid_collisions).grid.v_star[i];
}

double plastic_change(const StepRecord& record, std::size_t p) {
  return (record.behind(Stage::deformation).particles.F_P[p] - record.after[0].particles.F_P[p])
      .norm();
}

bool stopped(const StepRecord& record, std::size_t p) {
  return record.behind(Stage::particle_velocities).particles.v[p] !=
         record.behind(Stage::particle_collisions).particles.v[p];
}

std::string sentence(const std::vector<std::string>& facts, const std::string& otherwise) {
  if (facts.empty()) return otherwise;
  std::string text = "It ";
  for (std::size_t k = 0; k < facts.size(); ++k) {
    if (k > 0) text += k + 1 == facts.size() ? " and " : ", ";
    text += facts[k];
  }
  return text + ".";
}

}  // namespace

StepEvents events_of(const StepRecord& record) {
  StepEvents events;
  const Grid& grid = record.behind(Stage::grid_collisions).grid;
  for (std::size_t i = 0; i < grid.size(); ++i) events.nodes_in_contact += in_contact(record, i);
  for (std::size_t p = 0; p < record.after[0].particles.size(); ++p) {
    events.particles_yielding += plastic_change(record, p) > 0;
    events.particles_in_contact += stopped(record, p);
  }
  return events;
}

Choice choose_particle(const Scene& scene, const StepRecord& record) {
  const Particles& before = record.after[0].particles;
  const Grid& grid = record.behind(Stage::grid_collisions).grid;
  std::vector<NodeIndex> node;
  reference::Stencils stencils;
  stencils.build(scene, before, Stage::rasterize, node);
  std::vector<bool> touched(node.size(), false);
  for (std::size_t i = 0, at = 0; i < grid.size(); ++i) {
    while (!(node[at] == grid.node[i])) ++at;
    touched[at] = in_contact(record, i);
  }

  using Rank = std::tuple<int, double, double>;
  Rank best{-1, 0, 0};
  Choice choice;
  for (std::size_t p = 0; p < before.size(); ++p) {
    bool near_contact = false;
    stencils.for_each_node(
        p, [&](std::size_t i, double w_ip) { near_contact |= touched[i] && w_ip > 0; });
    const double yields = plastic_change(record, p);
    const bool stops = stopped(record, p);
    const Rank rank{4 * (yields > 0) + 2 * stops + near_contact, yields,
                    (record.after.back().particles.v[p] - before.v[p]).norm()};
    if (rank <= best) continue;
    best = rank;
    std::vector<std::string> facts;
    if (yields > 0) facts.emplace_back("yields in this step");
    if (stops) facts.emplace_back("meets a collider itself");
    if (near_contact) facts.emplace_back("has nodes in contact around it");
    choice = {p, sentence(facts, "Its velocity changes most.")};
  }
  return choice;
}

Choice choose_node(const StepRecord& record, const std::vector<StencilNode>& stencil) {
  std::pair<bool, double> best{false, -1};
  Choice choice;
  for (const StencilNode& n : stencil) {
    const std::pair<bool, double> rank{in_contact(record, n.node), n.w_ip};
    if (rank <= best) continue;
    best = rank;
    choice = {n.node, rank.first
                          ? "Among the particle's nodes in contact it has the largest weight."
                          : "Among the particle's nodes it has the largest weight."};
  }
  return choice;
}

Choice given_particle(const StepRecord& record, std::int64_t id) {
  const std::vector<std::int64_t>& ids = record.after[0].particles.id;
  const auto place = std::find(ids.begin(), ids.end(), id);
  if (place == ids.end())
    throw InputError("--particle", "id", std::to_string(id),
                     "the id of a particle, below " + std::to_string(ids.size()));
  return {static_cast<std::size_t>(place - ids.begin()), "It was chosen with --particle."};
}

Choice given_node(const StepRecord& record, const NodeIndex& node) {
  const std::vector<NodeIndex>& nodes = record.behind(Stage::rasterize).grid.node;
  const auto place = std::lower_bound(nodes.begin(), nodes.end(), node);
  if (place == nodes.end() || !(*place == node)) {
    std::string text = std::to_string(node.i);
    text.append(",").append(std::to_string(node.j)).append(",").append(std::to_string(node.k));
    throw InputError("--node", "i,j,k", text, "a node that has mass in the step shown");
  }
  return {static_cast<std::size_t>(place - nodes.begin()), "It was chosen with --node."};
}

}  // namespace firn::teach

// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <optional>

#include "verification/check/fields.hpp"

namespace firn::check {

namespace {

/// A fit holds if it leaves less than this of the numbers' size; a float solver's roundoff passes.
constexpr double fit_tolerance = 1e-4;

bool wrong(const Place& place) {
  return !(std::abs(place.subject_value - place.reference_value) <= place.bound);
}

std::vector<Place> wrong_ones(const Evidence& evidence) {
  std::vector<Place> list;
  for (const Place& place : evidence.places)
    if (wrong(place)) list.push_back(place);
  return list;
}

double heaviest(const Particles& particles) {
  return particles.m.empty() ? 0 : *std::max_element(particles.m.begin(), particles.m.end());
}

/// The number's place in the reference's grid; none: the reference has no such node.
std::optional<std::size_t> node_of(const Evidence& evidence, const Place& place) {
  const auto& nodes = evidence.reference.grid.node;
  const auto at = std::lower_bound(nodes.begin(), nodes.end(), place.node);
  if (at == nodes.end() || !(*at == place.node)) return {};
  return static_cast<std::size_t>(at - nodes.begin());
}

bool is_light(const Evidence& evidence, const Place& place) {
  const auto node = node_of(evidence, place);
  return !node || evidence.reference.grid.m[*node] < 1e-6 * heaviest(evidence.before.particles);
}

double distance_to_colliders(const Evidence& evidence, const Vec3& x) {
  double phi = 1e300;
  for (const Collider& collider : evidence.scene.colliders)
    phi = std::min(phi, collider.phi(x, evidence.before.time));
  return phi;
}

/// A property that wrong numbers may share.
struct Property {
  std::string phrase;  ///< "belong to nodes inside a collider"
  std::function<bool(const Place&)> holds;
};

std::vector<Property> node_properties(const Evidence& e) {
  const double h = e.scene.grid.spacing;
  return {
      {"belong to nodes lighter than 1e-6 m_p", [&e](const Place& p) { return is_light(e, p); }},
      {"belong to nodes inside a collider",
       [&e, h](const Place& p) {
         const Vec3 x = e.scene.grid.origin + h * Vec3(p.node.i, p.node.j, p.node.k);
         return distance_to_colliders(e, x) <= 0;
       }},
      {"belong to nodes of negative index",
       [](const Place& p) { return p.node.i < 0 || p.node.j < 0 || p.node.k < 0; }},
  };
}

std::vector<Property> particle_properties(const Evidence& e) {
  const Particles& before = e.before.particles;
  const Particles& after = e.reference.particles;
  const std::size_t n = before.size();
  const Vec3 o = e.scene.grid.origin;
  const double h = e.scene.grid.spacing;
  std::vector<Property> list = {
      {"belong to particles that yield",
       [&](const Place& p) { return before.F_P[p.index] != after.F_P[p.index]; }},
      {"belong to particles with J_P below 1",
       [&](const Place& p) { return before.F_P[p.index].determinant() < 1 - 1e-12; }},
      {"belong to particles with J_P above 1",
       [&](const Place& p) { return before.F_P[p.index].determinant() > 1 + 1e-12; }},
      {"belong to particles with an inverted F_E",
       [&](const Place& p) { return before.F_E[p.index].determinant() <= 0; }},
      {"belong to particles inside a collider",
       [&](const Place& p) { return distance_to_colliders(e, before.x[p.index]) <= 0; }},
      {"belong to particles within two cells of a collider",
       [&, h](const Place& p) { return distance_to_colliders(e, before.x[p.index]) <= 2 * h; }},
      {"belong to particles of unknown volume",
       [&](const Place& p) { return before.V_0[p.index] == 0; }},
      {"belong to particles of negative coordinates",
       [&](const Place& p) { return (before.x[p.index] - o).minCoeff() < 0; }},
  };
  for (const std::size_t width : {16, 8, 4})
    if (n % width != 0)
      list.push_back({fmt::format("belong to the last {} of {} particles, {} modulo {}", n % width,
                                  n, n, width),
                      [n, width](const Place& p) { return p.index >= n - n % width; }});
  for (std::size_t k = 0; k < e.scene.materials.size(); ++k)
    list.push_back(
        {fmt::format("belong to particles of material {} ({})", k, e.scene.materials[k].name),
         [&, k](const Place& p) {
           return before.material[p.index] == static_cast<std::int32_t>(k);
         }});
  return list;
}

std::vector<Property> component_properties(Field field) {
  static constexpr const char* axes[] = {"x", "y", "z"};
  std::vector<Property> list;
  if (components(field) == 3)
    for (int axis = 0; axis < 3; ++axis)
      list.push_back({fmt::format("are {} components", axes[axis]),
                      [axis](const Place& p) { return p.component == axis; }});
  if (components(field) == 9) {
    list.push_back({"lie on the diagonal", [](const Place& p) { return p.component % 4 == 0; }});
    list.push_back({"lie off the diagonal", [](const Place& p) { return p.component % 4 != 0; }});
  }
  return list;
}

/// The properties that every wrong number has and most numbers lack, the rarest first.
std::vector<std::string> patterns(const Evidence& evidence, const std::vector<Place>& bad) {
  struct Found {
    std::int64_t holders;
    std::string text;
  };
  std::vector<Found> found;
  const auto look = [&](const Property& property) {
    if (!std::all_of(bad.begin(), bad.end(), property.holds)) return;
    const auto holders =
        std::count_if(evidence.places.begin(), evidence.places.end(), property.holds);
    if (static_cast<double>(holders) > 0.9 * static_cast<double>(evidence.places.size())) return;
    found.push_back({holders, fmt::format("all wrong numbers {}: {} of {} such numbers are wrong",
                                          property.phrase, bad.size(), holders)});
  };
  const bool nodes = is_node_field(evidence.field);
  for (const Property& p : nodes ? node_properties(evidence) : particle_properties(evidence))
    look(p);
  for (const Property& p : component_properties(evidence.field)) look(p);
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.holders < b.holders; });
  std::vector<std::string> texts;
  for (const Found& each : found)
    if (texts.size() < 2) texts.push_back(each.text);
  return texts;
}

/// The field's value at a place before the stretch: of v_i* and v_i^{n+1} the velocity that the
/// stage starts from; none where there is no such thing.
std::optional<double> value_before(const Evidence& e, const Place& place) {
  if (!is_node_field(e.field)) return value(e.before, e.field, place.index, place.component);
  if (e.field != Field::node_velocity_star && e.field != Field::node_velocity_new) return {};
  const auto node = node_of(e, place);
  if (!node || *node >= e.before.grid.size()) return {};
  const Field from =
      e.before.grid.v_star.empty() ? Field::node_velocity : Field::node_velocity_star;
  if (length(e.before, from) != e.before.grid.size()) return {};
  return value(e.before, from, *node, place.component);
}

std::string named_factor(double c, const Evidence& e) {
  const double h = e.scene.grid.spacing, dt = e.dt, alpha = e.scene.flip;
  const std::pair<const char*, double> constants[] = {
      {"h", h},   {"1/h", 1 / h},   {"h²", h * h}, {"1/h²", 1 / (h * h)}, {"h³", h * h * h},
      {"Δt", dt}, {"1/Δt", 1 / dt}, {"α", alpha},  {"1 − α", 1 - alpha}};
  for (const auto& [name, constant] : constants)
    if (constant != 0 && std::abs(c / constant - 1) < fit_tolerance)
      return fmt::format(", and {} = {:.4g}", name, constant);
  return "";
}

struct Pair {
  double reference, subject;
};

/// c with subject = c·reference in all pairs.
std::optional<double> common_factor(const std::vector<Pair>& pairs) {
  double rr = 0, rs = 0, largest = 0;
  for (const Pair& p : pairs) {
    rr += p.reference * p.reference;
    rs += p.reference * p.subject;
    largest = std::max(largest, std::abs(p.subject));
  }
  if (rr == 0 || largest == 0) return {};
  const double c = rs / rr;
  for (const Pair& p : pairs)
    if (std::abs(p.subject - c * p.reference) > fit_tolerance * largest) return {};
  return c;
}

std::optional<std::string> fit_zero(const Evidence& e, const std::vector<Place>& bad) {
  if (!std::all_of(bad.begin(), bad.end(), [](const Place& p) { return p.subject_value == 0; }))
    return {};
  if (!bad.front().is_node) return "0 in the subject";
  const auto& theirs = e.subject.grid.node;
  const bool missing = std::all_of(bad.begin(), bad.end(), [&](const Place& p) {
    return !std::binary_search(theirs.begin(), theirs.end(), p.node);
  });
  return missing ? "the nodes are missing in the subject" : "0 in the subject";
}

std::optional<std::string> fit_factor(const Evidence& e, const std::vector<Place>& bad) {
  std::vector<Pair> pairs;
  for (const Place& p : bad) pairs.push_back({p.reference_value, p.subject_value});
  const auto c = common_factor(pairs);
  if (!c || std::abs(*c - 1) < 10 * fit_tolerance) return {};
  return fmt::format("subject = {:.4g} × reference{}", *c, named_factor(*c, e));
}

std::optional<std::string> fit_change(const Evidence& e, const std::vector<Place>& bad) {
  std::vector<Pair> pairs;
  double largest = 0;
  for (const Place& p : bad) {
    const auto before = value_before(e, p);
    if (!before) return {};
    pairs.push_back({p.reference_value - *before, p.subject_value - *before});
    largest = std::max(largest, std::abs(pairs.back().subject));
  }
  if (largest == 0) return "unchanged in the subject";
  const auto c = common_factor(pairs);
  if (!c || std::abs(*c - 1) < 10 * fit_tolerance) return {};
  return fmt::format("the subject's change = {:.4g} × the reference's{}", *c, named_factor(*c, e));
}

/// The same difference in every entry, axis by axis.
std::optional<std::string> fit_offset(const Evidence& e, const std::vector<Place>& bad) {
  if (components(e.field) != 3) return {};
  Vec3 offset = Vec3::Zero(), count = Vec3::Zero();
  for (const Place& p : bad) {
    offset[p.component] += p.subject_value - p.reference_value;
    count[p.component] += 1;
  }
  offset = offset.cwiseQuotient(count.cwiseMax(1));
  for (const Place& p : bad)
    if (std::abs(p.subject_value - p.reference_value - offset[p.component]) >
        fit_tolerance * offset.norm())
      return {};
  const Vec3 g_dt = e.dt * e.scene.gravity;
  for (const auto& [name, vector] : {std::pair<const char*, Vec3>{"gΔt", g_dt}, {"−gΔt", -g_dt}})
    if (vector.norm() > 0 && (offset - vector).norm() < fit_tolerance * vector.norm())
      return fmt::format("differs by {} everywhere", name);
  return fmt::format("differs by ({:.4g}, {:.4g}, {:.4g}) everywhere", offset[0], offset[1],
                     offset[2]);
}

std::optional<std::string> fit_transpose(const Evidence& e, const std::vector<Place>& bad) {
  if (components(e.field) != 9) return {};
  for (const Place& p : bad) {
    const double transposed =
        value(e.reference, e.field, p.index, 3 * (p.component % 3) + p.component / 3);
    if (std::abs(p.subject_value - transposed) >
        fit_tolerance * std::abs(p.subject_value - p.reference_value))
      return {};
  }
  return "the subject's matrix is the reference's transposed";
}

}  // namespace

double only_light_nodes(const Evidence& evidence) {
  if (!is_node_field(evidence.field)) return 0;
  const double m_p = heaviest(evidence.before.particles);
  double largest = 0;
  for (const Place& place : wrong_ones(evidence)) {
    const auto node = node_of(evidence, place);
    if (node) largest = std::max(largest, evidence.reference.grid.m[*node] / m_p);
  }
  return largest < 0.05 ? largest : 0;
}

std::vector<std::string> diagnose(const Evidence& evidence) {
  const std::vector<Place> bad = wrong_ones(evidence);
  std::vector<std::string> texts;
  if (bad.empty()) return texts;
  const bool finite = std::all_of(bad.begin(), bad.end(),
                                  [](const Place& p) { return std::isfinite(p.subject_value); });
  // A fit through one or two numbers says nothing.
  if (finite && bad.size() > 2)
    for (const auto& fit : {fit_zero, fit_change, fit_factor, fit_offset, fit_transpose})
      if (const auto text = fit(evidence, bad)) {
        texts.push_back(*text);
        break;
      }
  for (const std::string& text : patterns(evidence, bad)) texts.push_back(text);
  return texts;
}

}  // namespace firn::check

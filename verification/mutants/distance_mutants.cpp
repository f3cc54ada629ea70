// SPDX-License-Identifier: BSD-3-Clause
/// Mistakes that show far from the grid's origin, among very many nodes, and in particles that go
/// far in one step.

#include <algorithm>
#include <unordered_map>

#include "verification/mutants/stages.hpp"

namespace firn::mutants {

namespace {

/// One number for each node, by which a table finds it.
using Keys = std::function<std::vector<std::uint64_t>(const Grid&)>;

/// For each node the first one of the same key: itself if no other has it.
std::vector<std::size_t> first_of_key(const Grid& grid, const Keys& keys) {
  std::unordered_map<std::uint64_t, std::size_t> seen;
  std::vector<std::size_t> first;
  for (const std::uint64_t key : keys(grid))
    first.push_back(seen.emplace(key, first.size()).first->second);
  return first;
}

/// Nodes of one key are one place in memory: what is summed at any of them is seen at all.
Patch with_keys(const Keys& keys) {
  return [=](Stages& stages) {
    after(Stage::rasterize, [=](const Step& s) {
      Grid& grid = s.grid;
      const std::vector<std::size_t> first = first_of_key(grid, keys);
      for (std::size_t i = 0; i < first.size(); ++i) {
        const std::size_t j = first[i];
        const double m = grid.m[i] + grid.m[j];
        if (i == j || m == 0) continue;
        grid.v[j] = (grid.m[i] * grid.v[i] + grid.m[j] * grid.v[j]) / m;
        grid.m[j] = m;
      }
      for (std::size_t i = 0; i < first.size(); ++i) {
        grid.m[i] = grid.m[first[i]];
        grid.v[i] = grid.v[first[i]];
      }
    })(stages);
    after(Stage::grid_forces, [=](const Step& s) {
      const std::vector<std::size_t> first = first_of_key(s.grid, keys);
      for (std::size_t i = 0; i < first.size(); ++i)
        if (first[i] != i) s.grid.f[first[i]] += s.grid.f[i];
      for (std::size_t i = 0; i < first.size(); ++i) s.grid.f[i] = s.grid.f[first[i]];
    })(stages);
  };
}

/// The lowest `bits` of each index side by side.
std::uint64_t packed(const NodeIndex& n, int bits) {
  const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
  const auto part = [=](std::int32_t i) { return static_cast<std::uint32_t>(i) & mask; };
  return (part(n.i) << 2 * bits) | (part(n.j) << bits) | part(n.k);
}

/// A good hash of all three indices; two nodes of one hash are not to be found.
std::uint64_t hash(const NodeIndex& n) {
  std::uint64_t x = 0;
  for (const std::int32_t i : {n.i, n.j, n.k}) {
    x ^= static_cast<std::uint32_t>(i);
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    x ^= x >> 31;
  }
  return x;
}

std::uint64_t hash_in_32_bits(const NodeIndex& n) { return hash(n) >> 32; }

/// What single precision makes of the indices.
std::uint64_t hash_in_float(const NodeIndex& n) {
  const auto held = [](std::int32_t i) { return static_cast<std::int32_t>(static_cast<float>(i)); };
  return hash({held(n.i), held(n.j), held(n.k)});
}

Keys of_each(std::function<std::uint64_t(const NodeIndex&)> key) {
  return [=](const Grid& grid) {
    std::vector<std::uint64_t> keys;
    for (const NodeIndex& n : grid.node) keys.push_back(key(n));
    return keys;
  };
}

/// The number of each node in the box around all of them, z fastest, in 32 bits.
std::vector<std::uint64_t> numbers_in_box(const Grid& grid) {
  if (grid.node.empty()) return {};
  NodeIndex low = grid.node.front(), high = low;
  for (const NodeIndex& n : grid.node) {
    low = {std::min(low.i, n.i), std::min(low.j, n.j), std::min(low.k, n.k)};
    high = {std::max(high.i, n.i), std::max(high.j, n.j), std::max(high.k, n.k)};
  }
  const auto offset = [](std::int32_t a, std::int32_t b) {
    return static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b);
  };
  const std::uint32_t rows = offset(high.j, low.j) + 1, row = offset(high.k, low.k) + 1;
  return of_each([=](const NodeIndex& n) -> std::uint64_t {
    return (offset(n.i, low.i) * rows + offset(n.j, low.j)) * row + offset(n.k, low.k);
  })(grid);
}

/// Step 10 with x_p = `place(scene, x_p, u)`, u = Δt v_p.
Patch with_place(std::function<Vec3(const Scene&, const Vec3& x, const Vec3& u)> place) {
  return around(Stage::positions, [=](const StageFunction& right, const Step& s) {
    const std::vector<Vec3> x = s.particles.x;
    right(s);  // it judges whether anybody leaves the domain
    for (std::size_t p = 0; p < x.size(); ++p)
      s.particles.x[p] = place(s.scene, x[p], s.dt * s.particles.v[p]);
  });
}

/// One period up or down is all that is tried.
Vec3 wrapped_once(const Scene& scene, const Vec3& x_p, const Vec3& u) {
  const Vec3 low = scene.grid.origin, period = scene.grid.periodic;
  Vec3 x = x_p + u;
  for (int a = 0; a < 3; ++a) {
    if (period[a] <= 0) continue;
    if (x[a] < low[a])
      x[a] += period[a];
    else if (x[a] >= low[a] + period[a])
      x[a] -= period[a];
  }
  return x;
}

Vec3 two_cells_at_most(const Scene& scene, const Vec3& x_p, const Vec3& u) {
  const double most = 2 * scene.grid.spacing;
  return scene.wrap(x_p + u.cwiseMax(-most).cwiseMin(most));
}

}  // namespace

void add_distance_mutants(std::vector<Mutant>& list) {
  Adder add(list, Stage::rasterize);
  const auto key = [&](const char* name, const char* mistake, const char* origin, const Keys& keys,
                       const char* needs) {
    Mutant& mutant = add(name, mistake, origin, with_keys(keys));
    mutant.several = true;
    mutant.needs = needs;
    mutant.check_sees_it = false;
  };
  key("nodes_by_hash", "a table of nodes compares hashes of 32 bits, not the nodes",
      "collisions are rare", of_each(hash_in_32_bits), "some hundred thousand nodes");
  key("nodes_in_10_bits", "nodes 1024 apart along an axis are one: 10 bits of an index count",
      "Morton codes of 30 bits", of_each([](const NodeIndex& n) { return packed(n, 10); }),
      "particles 1024 cells apart");
  key("nodes_in_16_bits", "nodes 65 536 apart along an axis are one: 16 bits of an index count",
      "three indices in one number of 64 bits",
      of_each([](const NodeIndex& n) { return packed(n, 16); }), "particles 65 536 cells apart");
  key("nodes_in_float", "nodes whose indices are the same in single precision are one",
      "indices in the texture of a graphics card", of_each(hash_in_float),
      "particles 2^24 cells from the grid's origin");
  key("box_of_nodes_in_32_bits", "the number of a node in the box around all overflows 32 bits",
      "(i n_y + j) n_z + k in int", numbers_in_box, "particles further apart than 1290 cells");
  Mutant& contact =
      add("contact_in_16_bits", "step 5 places nodes by indices of 16 bits",
          "the grid was never that large",
          around(Stage::grid_collisions, [](const StageFunction& right, const Step& s) {
            const std::vector<NodeIndex> node = s.grid.node;
            for (NodeIndex& n : s.grid.node)
              n = {static_cast<std::int16_t>(n.i), static_cast<std::int16_t>(n.j),
                   static_cast<std::int16_t>(n.k)};
            right(s);
            s.grid.node = node;
          }));
  contact.stage = Stage::grid_collisions;
  contact.needs = "a collider more than 32 767 cells from the grid's origin";
  contact.check_sees_it = false;
  const auto move = [&](const char* name, const char* mistake, const char* origin, Patch patch,
                        const char* needs) {
    Mutant& mutant = add(name, mistake, origin, std::move(patch));
    mutant.stage = Stage::positions;
    mutant.needs = needs;
    mutant.check_sees_it = false;
  };
  move("wrapped_once", "a particle beyond a seam is moved by one period, however far it went",
       "an if instead of floor", with_place(wrapped_once),
       "a particle that crosses more than one period in a step");
  move("two_cells_at_most", "step 10 moves nobody by more than 2 cells", "a clamp for large steps",
       with_place(two_cells_at_most), "a particle that moves by more than 2 cells in a step");
}

}  // namespace firn::mutants

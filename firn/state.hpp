#pragma once
/// Everything that a time step reads and writes, always in double: a solver
/// that computes in float converts at load() and store(), both exactly where
/// its numbers are floats.

#include <cstdint>
#include <vector>

#include "firn/stage.hpp"
#include "firn/types.hpp"

namespace firn {

/// Particle quantities, structure of arrays, all of length size(). The index p
/// is the particle's place in the caller's order; solvers that sort give the
/// particles back in this order.
struct Particles {
  std::vector<Vec3> x;      ///< x_p, position [m]
  std::vector<Vec3> v;      ///< v_p, velocity [m/s]
  std::vector<double> m;    ///< m_p, mass [kg], > 0
  std::vector<double> V_0;  ///< V_p0, initial volume [m³]; 0 = not known yet, step 2 estimates it
  std::vector<Mat3> F_E;    ///< elastic deformation gradient [1]
  std::vector<Mat3> F_P;    ///< plastic deformation gradient [1]
  std::vector<std::int64_t> id;        ///< 0 … N−1 in body order
  std::vector<std::int32_t> material;  ///< index into Scene::materials

  std::size_t size() const { return x.size(); }

  /// Resizes every array; new particles are at rest, undeformed, of volume 0.
  void resize(std::size_t n);

  /// Appends all particles of `other`, ids included as they are.
  void append(const Particles& other);
};

/// Grid quantities at the nodes of positive mass, sorted by (i,j,k). Along a
/// periodic axis indices lie in [0, period/h). Arrays that the stages run so
/// far have not written are empty.
struct Grid {
  std::vector<NodeIndex> node;  ///< i = (i,j,k)
  std::vector<double> m;        ///< m_i [kg], after stage 1
  std::vector<Vec3> v;          ///< v_iⁿ [m/s], after stage 1; step 8 needs it
  std::vector<Vec3> f;          ///< f_i, elastic force [N], after stage 3
  std::vector<Vec3> v_star;     ///< v_i* [m/s], after stages 4 and 5
  /// Projector onto the directions that contact leaves free, after stage 5:
  /// identity = free, I − n nᵀ = slides, 0 = sticks. Only for semi-implicit scenes.
  std::vector<Mat3> free_directions;
  std::vector<Vec3> v_new;  ///< v_i^{n+1} [m/s], after stage 6

  std::size_t size() const { return node.size(); }
  void clear();
};

/// A simulation at a boundary between two stages.
struct State {
  double time = 0;                ///< tⁿ, start of the step [s]; advances with stage 10
  double dt = 0;                  ///< Δt of the step under way [s]; 0 between steps
  std::int64_t step = 0;          ///< n, steps completed
  Stage next = Stage::rasterize;  ///< the stage that comes next; `rasterize` = between steps
  Particles particles;
  Grid grid;  ///< meaningful inside a step; the last step's fields, or empty, between steps
};

}  // namespace firn

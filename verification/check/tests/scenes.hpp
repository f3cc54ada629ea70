#pragma once
/// Small scenes in which every stage has work to do.

#include "firn/scene.hpp"
#include "firn/state.hpp"

namespace firn::test {

/// A lump of some hundred particles with random deformations, partly compressed and
/// stretched beyond the elastic limits, that slides over and into a tilted plane with
/// friction and a sticky, rotating sphere. Volumes of every other particle are unknown.
struct Case {
  Scene scene;
  State state;
};
Case lump_on_slope();

/// The same with a step of 1 ms, five times what explicit steps bear, solved to 1e-6.
Case implicit_lump_on_slope();

/// The lump with the awkward cases planted: particles on nodes, on cell faces and a bit
/// beside them, coincident, alone and far away, a heavy one beside a light one; F_E
/// inverted, singular, a rotation, strongly compressed and stretched; F_P hardened and
/// softened.
Case awkward_lump();

/// The lump 20 000 cells from the world's origin, with a grid whose origin is there, too.
Case far_lump();

/// The lump without colliders in a box that is periodic along x.
Case periodic_lump();

}  // namespace firn::test

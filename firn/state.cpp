#include "firn/state.hpp"

namespace firn {

namespace {

template <class T>
void append_to(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

void Particles::resize(std::size_t n) {
  x.resize(n, Vec3::Zero());
  v.resize(n, Vec3::Zero());
  m.resize(n, 0.0);
  V_0.resize(n, 0.0);
  F_E.resize(n, Mat3::Identity());
  F_P.resize(n, Mat3::Identity());
  id.resize(n, 0);
  material.resize(n, 0);
}

void Particles::append(const Particles& other) {
  append_to(x, other.x);
  append_to(v, other.v);
  append_to(m, other.m);
  append_to(V_0, other.V_0);
  append_to(F_E, other.F_E);
  append_to(F_P, other.F_P);
  append_to(id, other.id);
  append_to(material, other.material);
}

void Grid::clear() { *this = Grid{}; }

}  // namespace firn

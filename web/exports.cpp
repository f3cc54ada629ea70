// SPDX-License-Identifier: BSD-3-Clause
/// Session as C functions, for JavaScript. One session at a time.

#include <memory>
#include <string>
#include <vector>

#include "web/session.hpp"

namespace {

using namespace firn;
using namespace firn::web;

std::unique_ptr<Session> session;
std::vector<double> numbers;  ///< what firn_array() returned last
std::string text;             ///< what a function returned as text last

void add(const Vec3& v) { numbers.insert(numbers.end(), v.data(), v.data() + 3); }
void add(double x) { numbers.push_back(x); }
void add(const Strain& s) { numbers.insert(numbers.end(), {s.J_E, s.J_P, s.smallest, s.largest}); }
void add(const NodeIndex& n) { numbers.insert(numbers.end(), {1.0 * n.i, 1.0 * n.j, 1.0 * n.k}); }
void add(const Mat3& M) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) numbers.push_back(M(row, column));
}

template <class T>
void add_all(const std::vector<T>& from) {
  for (const T& x : from) add(x);
}

void fill(const std::string& name) {
  const State& state = session->state();
  if (name == "x_p") add_all(state.particles.x);
  if (name == "v_p") add_all(state.particles.v);
  if (name == "m_p") add_all(state.particles.m);
  if (name == "V_p0") add_all(state.particles.V_0);
  if (name == "F_E") add_all(state.particles.F_E);
  if (name == "F_P") add_all(state.particles.F_P);
  if (name == "strain") add_all(session->strains());
  if (name == "node") add_all(state.grid.node);
  if (name == "m_i") add_all(state.grid.m);
  if (name == "v_i") add_all(state.grid.v);
  if (name == "f_i") add_all(state.grid.f);
  if (name == "v_star") add_all(state.grid.v_star);
  if (name == "v_new") add_all(state.grid.v_new);
  if (name == "invariants") {
    const Invariants sum = session->invariants();
    add(sum.mass);
    add(sum.momentum);
    add_all(std::vector<double>{sum.kinetic, sum.elastic, sum.gravitational, sum.grid_mass});
    add(sum.grid_momentum);
    add(sum.grid_kinetic);
  }
}

}  // namespace

extern "C" {

void firn_start(int preset) { session = std::make_unique<Session>(static_cast<Preset>(preset)); }
void firn_restart() { session->restart(); }
void firn_set(int parameter, double value) {
  session->set(static_cast<Parameter>(parameter), value);
}
double firn_get(int parameter) { return session->get(static_cast<Parameter>(parameter)); }

/// 1: the stage is done; 0: it failed, firn_error() tells why.
int firn_advance() { return session->advance() ? 1 : 0; }
const char* firn_error() { return session->error().c_str(); }

int firn_next_stage() { return number(session->state().next); }
double firn_time() { return session->state().time; }
double firn_steps() { return static_cast<double>(session->state().step); }

/// The named array as doubles; firn_array_size() counts them. Valid until the next call.
const double* firn_array(const char* name) {
  numbers.clear();
  fill(name);
  return numbers.data();
}
int firn_array_size() { return static_cast<int>(numbers.size()); }

const char* firn_hash() {
  constexpr char digits[] = "0123456789abcdef";
  std::uint64_t h = session->hash();
  text.assign(16, '0');
  for (auto digit = text.rbegin(); digit != text.rend(); ++digit, h >>= 4) *digit = digits[h & 15];
  return text.c_str();
}
}

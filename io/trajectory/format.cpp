// SPDX-License-Identifier: BSD-3-Clause
#include "io/trajectory/format.hpp"

#include <algorithm>

namespace firn {

namespace {

/// The columns of diagnostics_columns in order, each handed to `visit` as a
/// pointer to its first double or as a reference to its integer.
template <class Row, class VisitReal, class VisitInteger>
void visit_column(Row& d, std::size_t column, VisitReal real, VisitInteger integer) {
  switch (column) {
    case 0: return real(&d.time);
    case 1: return real(&d.dt);
    case 2: return real(&d.mass);
    case 3: return real(d.momentum.data());
    case 4: return real(d.angular_momentum.data());
    case 5: return real(&d.kinetic_energy);
    case 6: return real(&d.elastic_energy);
    case 7: return real(&d.gravitational_energy);
    case 8: return real(d.center_of_mass.data());
    case 9: return real(&d.max_speed);
    case 10: return real(&d.min_J_E);
    case 11: return real(&d.max_J_E);
    case 12: return integer(d.grid_nodes);
    case 13: return integer(d.solver_iterations);
    case 14: return real(&d.solver_residual);
  }
}

}  // namespace

void get_column(const DiagnosticsRow& row, std::size_t column, double* values) {
  visit_column(
      row, column,
      [&](const double* v) { std::copy_n(v, diagnostics_columns[column].components, values); },
      [&](std::int64_t n) { *values = static_cast<double>(n); });
}

void set_column(DiagnosticsRow& row, std::size_t column, const double* values) {
  visit_column(
      row, column,
      [&](double* v) { std::copy_n(values, diagnostics_columns[column].components, v); },
      [&](std::int64_t& n) { n = static_cast<std::int64_t>(*values); });
}

}  // namespace firn

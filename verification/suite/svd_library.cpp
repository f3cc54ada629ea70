// SPDX-License-Identifier: BSD-3-Clause
#include "verification/suite/svd_library.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <dlfcn.h>
#include <filesystem>
#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "firn/error.hpp"
#include "verification/oracles/svd_families.hpp"
#include "verification/oracles/svd_oracle.hpp"
#include "verification/suite/firn_svd.h"

namespace firn::suite {

namespace {

using verification::Matrix;

constexpr int matrices_per_family = 20000;

/// Bounds, in eps of the type: a dozen roundings of unit numbers stand behind each; random signs
/// leave the 99.9th percentile at half of the largest.
constexpr double backward_bound = 10, orthogonality_bound = 12, sigma_bound = 6;

struct Spread {
  std::vector<double> values;
  void add(long double x) { values.push_back(static_cast<double>(x)); }
  double largest() const {
    return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
  }
  double most() {
    if (values.empty()) return 0;
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  }
};

template <class T>
using Function = void (*)(const T*, T*, T*, T*);

template <class T>
bool test_family(const verification::Family& family, Function<T> svd, std::uint64_t seed,
                 std::string& table) {
  verification::Random random(seed);
  const long double eps = std::numeric_limits<T>::epsilon();
  const long double grain = std::numeric_limits<T>::denorm_min();
  Spread backward, orthogonality, sigma;
  int wrong = 0;
  for (int n = 0; n < matrices_per_family; ++n) {
    const Matrix wanted = family.make(random, sizeof(T) == 4);
    T A[9], U[9], s[3], V[9];
    Matrix exact_A;
    for (std::size_t k = 0; k < 9; ++k) A[k] = static_cast<T>(wanted[k]), exact_A[k] = A[k];
    svd(A, U, s, V);
    verification::Svd computed;
    for (std::size_t k = 0; k < 9; ++k) computed.U[k] = U[k], computed.V[k] = V[k];
    for (std::size_t k = 0; k < 3; ++k) computed.sigma[k] = s[k];
    const verification::SvdErrors e =
        verification::svd_errors(exact_A, computed, verification::svd_oracle(exact_A), eps, grain);
    wrong += e.finite && e.rotations && e.ordered && e.sign ? 0 : 1;
    if (!e.finite) continue;
    backward.add(e.backward);
    orthogonality.add(std::max(e.orthogonality_U, e.orthogonality_V));
    sigma.add(e.sigma);
  }
  const double b = backward.largest(), o = orthogonality.largest(), s = sigma.largest();
  const bool valid = wrong == 0 && b <= backward_bound && o <= orthogonality_bound &&
                     s <= sigma_bound && backward.most() <= 0.5 * backward_bound &&
                     orthogonality.most() <= 7 && sigma.most() <= 0.5 * sigma_bound;
  fmt::format_to(std::back_inserter(table), "{:<7} {:<40} {:>9.3g} {:>9.3g} {:>9.3g} {:>7} {}\n",
                 sizeof(T) == 4 ? "float" : "double", family.name, b, o, s, wrong,
                 valid ? "VALID" : "INVALID");
  return valid;
}

/// NaN and infinity in, NaN out, in bounded time.
template <class T>
bool test_not_finite(Function<T> svd, std::string& table) {
  int wrong = 0;
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity()})
    for (std::size_t k = 0; k < 9; ++k) {
      T A[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, U[9], s[3], V[9];
      A[k] = bad;
      svd(A, U, s, V);
      for (const T x : s) wrong += std::isnan(x) ? 0 : 1;
      for (std::size_t n = 0; n < 9; ++n) wrong += std::isnan(U[n]) && std::isnan(V[n]) ? 0 : 1;
    }
  fmt::format_to(std::back_inserter(table), "{:<7} {:<40} {:>9} {:>9} {:>9} {:>7} {}\n",
                 sizeof(T) == 4 ? "float" : "double", "NaN and infinity", "", "", "", wrong,
                 wrong == 0 ? "VALID" : "INVALID");
  return wrong == 0;
}

template <class T>
bool test_all(void* function, std::string& table) {
  if (function == nullptr) return true;
  Function<T> svd;
  static_assert(sizeof svd == sizeof function);
  std::memcpy(&svd, &function, sizeof svd);
  bool valid = true;
  std::uint64_t seed = 1;
  for (const verification::Family& family : verification::svd_families())
    valid = test_family<T>(family, svd, seed++, table) && valid;
  return test_not_finite<T>(svd, table) && valid;
}

/// In the child: the whole test, its table to `out`.
[[noreturn]] void child(const std::string& path, double time_limit, int out) {
  alarm(static_cast<unsigned>(std::ceil(time_limit)));
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) _exit(4);
  void* in_double = dlsym(library, FIRN_SVD_DOUBLE_NAME);
  void* in_float = dlsym(library, FIRN_SVD_FLOAT_NAME);
  if (in_double == nullptr && in_float == nullptr) _exit(5);
  std::string table;
  const bool of_double = test_all<double>(in_double, table),
             of_float = test_all<float>(in_float, table);
  for (std::size_t at = 0; at < table.size();) {
    const ssize_t n = write(out, table.data() + at, table.size() - at);
    if (n <= 0) _exit(6);
    at += static_cast<std::size_t>(n);
  }
  _exit(of_double && of_float ? 0 : 1);
}

}  // namespace

SvdReport verify_svd_library(const std::string& path, double time_limit) {
  if (!std::filesystem::is_regular_file(path))
    throw InputError("--svd", "shared library", path, "an existing file");
  int ends[2];
  if (pipe(ends) != 0) throw InputError("--svd", "pipe", std::strerror(errno), "two descriptors");
  const pid_t pid = fork();
  if (pid < 0) throw InputError("--svd", "process", std::strerror(errno), "one more process");
  if (pid == 0) child(std::filesystem::absolute(path).string(), time_limit, ends[1]);
  close(ends[1]);
  SvdReport report;
  report.table =
      fmt::format("{:<7} {:<40} {:>9} {:>9} {:>9} {:>7} {}\n", "type", "family, errors in eps",
                  "backward", "orthog.", "sigma", "wrong", "verdict");
  char buffer[4096];
  for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;)
    report.table.append(buffer, static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  waitpid(pid, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 4)
    throw InputError("--svd", "shared library", path, "one that can be loaded");
  if (WIFEXITED(status) && WEXITSTATUS(status) == 5)
    throw InputError("--svd", "functions of the library", "none",
                     FIRN_SVD_DOUBLE_NAME " or " FIRN_SVD_FLOAT_NAME " (firn_svd.h)");
  report.valid = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (WIFSIGNALED(status))
    report.table += WTERMSIG(status) == SIGALRM
                        ? fmt::format("no answer within {} s\n", to_text(time_limit))
                        : fmt::format("the library was killed by signal {} ({})\n",
                                      WTERMSIG(status), strsignal(WTERMSIG(status)));
  report.table +=
      fmt::format("\n{}: {} (wrong: not finite, not a rotation, not sorted, or the wrong sign)\n",
                  report.valid ? "VALID" : "INVALID", path);
  return report;
}

}  // namespace firn::suite

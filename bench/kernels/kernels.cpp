/// Google Benchmark on the per-particle kernels and on what Eigen and GSL offer for the
/// same task. Every decomposition is judged before it is timed.

#include <Eigen/Dense>
#include <benchmark/benchmark.h>
#include <cmath>
#include <gsl/gsl_linalg.h>
#include <memory>

#include "bench/bench.hpp"
#include "bench/kernels/matrices.hpp"
#include "bench/suites.hpp"
#include "firn/error.hpp"
#include "firn/material.hpp"
#include "optimized/kernels/batch.hpp"
#include "reference/svd.hpp"

namespace firn::bench {

namespace {

using results::Quantity;

constexpr std::size_t count = 1024;  // stays in the second-level cache
constexpr std::size_t packets = count / kernels::packet_size;

/// Keeps the time of every repetition and prints nothing.
class Collector : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Iteration)
        seconds.push_back(run.real_accumulated_time / static_cast<double>(run.iterations));
  }
  std::vector<double> seconds;
};

/// Nanoseconds per item of `body`, which treats `count` items, nine repetitions.
void time_body(const std::function<void()>& body, results::Case& result) {
  static bool initialized = false;
  if (!initialized) {
    static char program[] = "firn";
    char* arguments[] = {program, nullptr};
    int number = 1;
    benchmark::Initialize(&number, arguments);
    initialized = true;
  }
  benchmark::ClearRegisteredBenchmarks();
  benchmark::RegisterBenchmark("kernel",
                               [&body](benchmark::State& state) {
                                 for ([[maybe_unused]] auto once : state) {
                                   body();
                                   benchmark::ClobberMemory();
                                 }
                               })
      ->Repetitions(9)
      ->MinTime(0.02)
      ->UseRealTime();
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector, nullptr, "kernel");
  Quantity time{"time", "ns", "wall time per item", Quantity::Better::lower, {}, true};
  for (const double seconds : collector.seconds)
    time.values.push_back(1e9 * seconds / static_cast<double>(count));
  result.quantities = {time};
}

void plan_kernel(const std::string& kernel, const std::string& code, const std::string& precision,
                 std::function<void(results::Case&)> run, std::vector<CasePlan>& plans) {
  CasePlan plan;
  plan.description.suite = "kernels";
  plan.description.name = kernel + "," + code + "," + precision;
  plan.description.title = plan.description.name;
  plan.description.parameters = {{"kernel", kernel}, {"code", code}, {"precision", precision}};
  plan.quick = true;
  plan.run = std::move(run);
  plans.push_back(std::move(plan));
}

/// Ours keep 10 and 12 eps on every family; a library is timed if it is anywhere near
/// working accuracy, and what it reaches stands beside its time.
void judge_svd(const SvdQuality& quality, bool ours, results::Case& result) {
  const double backward = ours ? 10 : 100, orthogonality = ours ? 12 : 100;
  result.validation = "backward error " + to_text(quality.backward) + " eps, orthogonality " +
                      to_text(quality.orthogonality) + " eps; allowed " + to_text(backward) +
                      " and " + to_text(orthogonality);
  if (quality.backward <= backward && quality.orthogonality <= orthogonality) return;
  result.status = results::Status::invalid;
  result.message = "not of working accuracy: " + result.validation;
}

template <class T>
void time_batch_svd(const std::string& family, std::uint64_t seed, results::Case& result) {
  const std::vector<Mat3> plain = matrices(family, count, seed);
  const std::vector<T> A = pack<T>(plain);
  std::vector<T> U(A.size()), V(A.size()), sigma(A.size() / 3);
  const auto& batch = kernels::batch_kernels<T>();
  batch.svd(A.data(), U.data(), sigma.data(), V.data(), packets);
  SvdQuality quality;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 s;
    for (std::size_t c = 0; c < 3; ++c)
      s[static_cast<int>(c)] =
          static_cast<double>(sigma[(i / kernels::packet_size * 3 + c) * kernels::packet_size +
                                    i % kernels::packet_size]);
    quality.take(unpack(A, i), unpack(U, i), s, unpack(V, i),
                 std::is_same_v<T, float> ? 0x1p-23 : 0x1p-52);
  }
  judge_svd(quality, true, result);
  result.parameters.emplace_back("target", std::string(batch.target));
  if (result.status == results::Status::measured)
    time_body([&] { batch.svd(A.data(), U.data(), sigma.data(), V.data(), packets); }, result);
}

struct Decomposed {
  Mat3 U, V;
  Vec3 sigma;
};

Decomposed by_reference(const Mat3& A) {
  const reference::Svd s = reference::svd(A);
  return {s.U, s.V, s.sigma};
}

Decomposed by_eigen(const Mat3& A) {
  const Eigen::JacobiSVD<Mat3> s(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {s.matrixU(), s.matrixV(), s.singularValues()};
}

Decomposed by_gsl(const Mat3& A) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  RowMajor U = A, V;
  Vec3 sigma;
  gsl_matrix_view u = gsl_matrix_view_array(U.data(), 3, 3),
                  v = gsl_matrix_view_array(V.data(), 3, 3);
  gsl_vector_view s = gsl_vector_view_array(sigma.data(), 3);
  gsl_linalg_SV_decomp_jacobi(&u.matrix, &v.matrix, &s.vector);
  return {U, V, sigma};
}

void time_plain_svd(Decomposed (*svd)(const Mat3&), const std::string& family, std::uint64_t seed,
                    results::Case& result) {
  const std::vector<Mat3> A = matrices(family, count, seed);
  std::vector<Decomposed> out(count);
  SvdQuality quality;
  for (const Mat3& matrix : A) {
    const Decomposed d = svd(matrix);
    quality.take(matrix, d.U, d.sigma, d.V, 0x1p-52);
  }
  judge_svd(quality, svd == by_reference, result);
  if (result.status != results::Status::measured) return;
  time_body(
      [&] {
        for (std::size_t i = 0; i < count; ++i) out[i] = svd(A[i]);
      },
      result);
}

template <class T>
std::vector<T> minus_identity(const std::vector<Mat3>& F) {
  std::vector<Mat3> E = F;
  for (Mat3& e : E) e -= Mat3::Identity();
  return pack<T>(E);
}

/// Polar factor near a rotation; judged by the symmetry of RᵀF and by RᵀR.
template <class T>
void time_polar(std::uint64_t seed, results::Case& result) {
  const std::vector<T> F = pack<T>(matrices("elastic", count, seed));
  std::vector<T> R(F.size());
  const auto& batch = kernels::batch_kernels<T>();
  batch.polar_near_rotation(F.data(), R.data(), packets);
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Mat3 r = unpack(R, i), S = r.transpose() * unpack(F, i);
    worst = std::max(
        {worst, (S - S.transpose()).norm(), (r.transpose() * r - Mat3::Identity()).norm()});
  }
  const double eps = std::is_same_v<T, float> ? 0x1p-23 : 0x1p-52;
  result.validation = "symmetry of RᵀF and RᵀR − I: " + to_text(worst / eps) + " eps, allowed 8";
  // ‖S − Sᵀ‖ is √2·2 times the skew part, of which Newton's polar leaves 2 eps.
  if (!(worst <= 8 * eps)) {
    result.status = results::Status::invalid;
    result.message = result.validation;
    return;
  }
  time_body([&] { batch.polar_near_rotation(F.data(), R.data(), packets); }, result);
}

/// Step 7 on fresh copies each time (the copy, 18 numbers, is timed with it). Judged by
/// F_E F_P against F before, and by the singular values against the box.
template <class T>
void time_return_map(const std::string& family, bool by_svd, std::uint64_t seed,
                     results::Case& result) {
  const Material snow;
  const auto box = kernels::ElasticBox<T>::from(snow.critical_compression, snow.critical_stretch);
  const std::vector<Mat3> F = matrices(family, count, seed);
  const std::vector<T> E = minus_identity<T>(F), P(E.size(), T{0});
  std::vector<T> F_E = E, F_P = P, changed(count);
  const auto& batch = kernels::batch_kernels<T>();
  const auto map = by_svd ? batch.return_map_svd : batch.return_map;
  map(box, F_E.data(), F_P.data(), changed.data(), packets);
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Mat3 elastic = Mat3::Identity() + unpack(F_E, i),
               plastic = Mat3::Identity() + unpack(F_P, i);
    const Mat3 before = Mat3::Identity() + unpack(E, i);
    const Vec3 s = reference::svd(elastic).sigma;
    worst =
        std::max({worst, (elastic * plastic - before).norm(), s[0] - snow.largest_elastic_stretch(),
                  snow.smallest_elastic_stretch() - s[2]});
  }
  const double eps = std::is_same_v<T, float> ? 0x1p-23 : 0x1p-52;
  result.validation =
      "F_E F_P against F, singular values against the box: " + to_text(worst / eps) +
      " eps, allowed 64";
  if (!(worst <= 64 * eps)) {
    result.status = results::Status::invalid;
    result.message = result.validation;
    return;
  }
  time_body(
      [&] {
        std::copy(E.begin(), E.end(), F_E.begin());
        std::copy(P.begin(), P.end(), F_P.begin());
        map(box, F_E.data(), F_P.data(), changed.data(), packets);
      },
      result);
}

template <class T>
void time_exp(std::uint64_t seed, results::Case& result) {
  const std::vector<Mat3> random = matrices("Gaussian", count, seed);
  std::vector<T> x(count), y(count);
  for (std::size_t i = 0; i < count; ++i) x[i] = static_cast<T>(random[i](0, 0));
  const auto& batch = kernels::batch_kernels<T>();
  batch.exp(x.data(), y.data(), packets);
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i)
    worst = std::max(worst,
                     std::abs(static_cast<double>(y[i]) / std::exp(static_cast<double>(x[i])) - 1));
  const double eps = std::is_same_v<T, float> ? 0x1p-23 : 0x1p-52;
  result.validation = "against libm in double: " + to_text(worst / eps) + " eps, allowed 4";
  if (!(worst <= 4 * eps)) {
    result.status = results::Status::invalid;
    result.message = result.validation;
    return;
  }
  time_body([&] { batch.exp(x.data(), y.data(), packets); }, result);
}

template <class T>
void plan_ours(const char* precision, std::uint64_t seed, std::vector<CasePlan>& plans) {
  for (const char* family : {"snow", "Gaussian"})
    plan_kernel(
        std::string("SVD, ") + family, "optimized", precision,
        [=](results::Case& r) { time_batch_svd<T>(family, seed, r); }, plans);
  plan_kernel(
      "polar, elastic", "optimized", precision, [=](results::Case& r) { time_polar<T>(seed, r); },
      plans);
  for (const char* family : {"elastic", "snow"})
    for (const bool by_svd : {false, true})
      plan_kernel(
          std::string("return map, ") + family, by_svd ? "optimized, by SVD" : "optimized",
          precision, [=](results::Case& r) { time_return_map<T>(family, by_svd, seed, r); }, plans);
  plan_kernel(
      "exp", "optimized", precision, [=](results::Case& r) { time_exp<T>(seed, r); }, plans);
}

}  // namespace

void plan_kernels_suite(const Registry&, const Options& options, std::vector<CasePlan>& plans) {
  const std::uint64_t seed = options.seed;
  plan_ours<float>("float", seed, plans);
  plan_ours<double>("double", seed, plans);
  const std::pair<const char*, Decomposed (*)(const Mat3&)> peers[] = {
      {"reference", by_reference}, {"Eigen JacobiSVD", by_eigen}, {"GSL SV_decomp_jacobi", by_gsl}};
  for (const auto& [code, svd] : peers)
    for (const char* family : {"snow", "Gaussian"})
      plan_kernel(
          std::string("SVD, ") + family, code, "double",
          [=, svd = svd](results::Case& r) { time_plain_svd(svd, family, seed, r); }, plans);
}

}  // namespace firn::bench

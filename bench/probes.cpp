// SPDX-License-Identifier: BSD-3-Clause
#include "bench/probes.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/probes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace firn::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// 16 independent chains hide a latency of 4 cycles on two units with room to spare.
template <class T>
double fma_chains(std::size_t rounds) {
  const hn::ScalableTag<T> d;
  const auto a = hn::Set(d, static_cast<T>(0.999)), b = hn::Set(d, static_cast<T>(0.001));
  auto x0 = hn::Iota(d, T{0}), x1 = hn::Add(x0, b), x2 = hn::Add(x1, b), x3 = hn::Add(x2, b);
  auto x4 = hn::Add(x3, b), x5 = hn::Add(x4, b), x6 = hn::Add(x5, b), x7 = hn::Add(x6, b);
  auto y0 = hn::Add(x7, b), y1 = hn::Add(y0, b), y2 = hn::Add(y1, b), y3 = hn::Add(y2, b);
  for (std::size_t i = 0; i < rounds; ++i) {
    x0 = hn::MulAdd(x0, a, b), x1 = hn::MulAdd(x1, a, b), x2 = hn::MulAdd(x2, a, b);
    x3 = hn::MulAdd(x3, a, b), x4 = hn::MulAdd(x4, a, b), x5 = hn::MulAdd(x5, a, b);
    x6 = hn::MulAdd(x6, a, b), x7 = hn::MulAdd(x7, a, b), y0 = hn::MulAdd(y0, a, b);
    y1 = hn::MulAdd(y1, a, b), y2 = hn::MulAdd(y2, a, b), y3 = hn::MulAdd(y3, a, b);
  }
  const auto sum =
      hn::Add(hn::Add(hn::Add(x0, x1), hn::Add(x2, x3)), hn::Add(hn::Add(x4, x5), hn::Add(x6, x7)));
  volatile T keep =
      hn::GetLane(hn::SumOfLanes(d, hn::Add(sum, hn::Add(hn::Add(y0, y1), hn::Add(y2, y3)))));
  (void)keep;
  return 2.0 * 12.0 * static_cast<double>(hn::Lanes(d)) * static_cast<double>(rounds);
}

double fma_float(std::size_t rounds) { return fma_chains<float>(rounds); }
double fma_double(std::size_t rounds) { return fma_chains<double>(rounds); }

void triad(double* a, const double* b, const double* c, std::size_t n) {
  const hn::ScalableTag<double> d;
  const auto s = hn::Set(d, 3.0);
  for (std::size_t i = 0; i < n; i += hn::Lanes(d))
    hn::StoreU(hn::MulAdd(s, hn::LoadU(d, c + i), hn::LoadU(d, b + i)), d, a + i);
}

double sum(const double* a, std::size_t n) {
  const hn::ScalableTag<double> d;
  const std::size_t lanes = hn::Lanes(d);
  auto s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0;
  for (std::size_t i = 0; i < n; i += 4 * lanes) {
    s0 = hn::Add(s0, hn::LoadU(d, a + i)), s1 = hn::Add(s1, hn::LoadU(d, a + i + lanes));
    s2 = hn::Add(s2, hn::LoadU(d, a + i + 2 * lanes));
    s3 = hn::Add(s3, hn::LoadU(d, a + i + 3 * lanes));
  }
  return hn::GetLane(hn::SumOfLanes(d, hn::Add(hn::Add(s0, s1), hn::Add(s2, s3))));
}

const char* target_name() { return hwy::TargetName(HWY_TARGET); }

}  // namespace firn::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace firn::bench {

HWY_EXPORT(fma_float);
HWY_EXPORT(fma_double);
HWY_EXPORT(triad);
HWY_EXPORT(sum);
HWY_EXPORT(target_name);

namespace {

/// Work (flop or byte) per second of `threads` threads that start together; `work`
/// does its share and says how much that was.
double rate(int threads, const std::function<double(int)>& work) {
  std::vector<double> done(static_cast<std::size_t>(threads));
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::thread> team;
  for (int t = 1; t < threads; ++t)
    team.emplace_back([&, t] { done[static_cast<std::size_t>(t)] = work(t); });
  done[0] = work(0);
  for (std::thread& member : team) member.join();
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  double total = 0;
  for (const double share : done) total += share;
  return total / seconds;
}

constexpr std::size_t rounds = 4'000'000;  // some 20 ms at 3 GHz, two units

/// 256 MB an array for all threads together.
constexpr std::size_t elements = std::size_t{1} << 25;

/// Pages are touched here, by the caller, once for all repetitions.
struct Arrays {
  std::vector<double> a = std::vector<double>(elements, 1.0);
  std::vector<double> b = a, c = a;
};

Arrays& arrays() {
  static Arrays shared;
  return shared;
}

}  // namespace

std::string instruction_set() { return HWY_DYNAMIC_DISPATCH(target_name)(); }

double fma_peak_float(int threads) {
  return rate(threads, [](int) { return HWY_DYNAMIC_DISPATCH(fma_float)(rounds); });
}

double fma_peak_double(int threads) {
  return rate(threads, [](int) { return HWY_DYNAMIC_DISPATCH(fma_double)(rounds); });
}

double calibration_loop() {
  const auto start = std::chrono::steady_clock::now();
  // 2^20 dependent steps of 4–8 cycles; the volatile seed keeps the compiler from knowing the end.
  volatile double seed = 1.0;
  double x = seed;
  for (int i = 0; i < (1 << 20); ++i) x = x * 0.999999 + 1e-6;
  seed = x;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double triad_bandwidth(int threads) {
  Arrays& x = arrays();
  const std::size_t share = elements / static_cast<std::size_t>(threads) / 64 * 64;
  return rate(threads, [&, share](int t) {
    const std::size_t first = share * static_cast<std::size_t>(t);
    HWY_DYNAMIC_DISPATCH(triad)(&x.a[first], &x.b[first], &x.c[first], share);
    return 24.0 * static_cast<double>(share);
  });
}

double read_bandwidth(int threads) {
  Arrays& x = arrays();
  const std::size_t share = elements / static_cast<std::size_t>(threads) / 64 * 64;
  return rate(threads, [&, share](int t) {
    volatile double keep =
        HWY_DYNAMIC_DISPATCH(sum)(&x.b[share * static_cast<std::size_t>(t)], share);
    (void)keep;
    return 8.0 * static_cast<double>(share);
  });
}

}  // namespace firn::bench
#endif  // HWY_ONCE

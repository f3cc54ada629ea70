// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What this machine can do at best: the lines of a roofline.

#include <string>

namespace firn::bench {

/// Name of the widest instruction set that this processor has and the probes use.
std::string instruction_set();

/// Fused multiply-adds on registers only, by `threads` threads at once [flop/s, 2 per FMA].
double fma_peak_float(int threads);
double fma_peak_double(int threads);

/// Seconds that a fixed chain of dependent multiply-adds takes (about 2 ms): the
/// same work every time, so that its spread is the machine's noise.
double calibration_loop();

/// a_i = b_i + s c_i over arrays far larger than the caches, 24 bytes of traffic
/// that the program asks for per element [byte/s].
double triad_bandwidth(int threads);
/// Σ a_i [byte/s].
double read_bandwidth(int threads);

}  // namespace firn::bench

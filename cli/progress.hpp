// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A progress bar on stderr, drawn only where stderr is a terminal.

#include <chrono>
#include <string>

namespace firn::cli {

class ProgressBar {
 public:
  explicit ProgressBar(std::string title);
  ~ProgressBar() { finish(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `fraction` in [0, 1] of the work done; redraws at most ten times a second.
  void show(double fraction, const std::string& detail);

  /// Clears the line, so that messages start on a clean one.
  void finish();

  bool is_terminal() const { return is_terminal_; }

 private:
  using Clock = std::chrono::steady_clock;
  std::string title_;
  bool is_terminal_ = false;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_{};
};

/// "1 h 02 min", "3 min 20 s", "12 s".
std::string duration_text(double seconds);

}  // namespace firn::cli

// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What takes longer than two seconds says so on stderr: a bar where stderr is a terminal, else a
/// plain line now and then.

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace firn::cli {

using Seconds = std::chrono::duration<double>;

/// When a plain line is due, where there is no terminal for a bar: after every minute.
class LineSchedule {
 public:
  bool due(double seconds);

 private:
  double next_ = 60;
};

class ProgressBar {
 public:
  explicit ProgressBar(std::string title);
  ~ProgressBar() { finish(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `fraction` in [0, 1] of the work done; draws at most ten times a second.
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
  LineSchedule lines_;
};

/// Tells on a thread of its own that something is under way which cannot tell itself.
class Waiting {
 public:
  explicit Waiting(std::string what);
  ~Waiting();
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  void watch();

  std::string what_;
  std::mutex mutex_;
  std::condition_variable over_;
  bool is_over_ = false;
  std::thread thread_;
};

/// "1 h 02 min", "3 min 20 s", "12 s".
std::string duration_text(double seconds);

}  // namespace firn::cli

// SPDX-License-Identifier: BSD-3-Clause
#include "cli/progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/core.h>
#include <unistd.h>

namespace firn::cli {

ProgressBar::ProgressBar(std::string title)
    : title_(std::move(title)), is_terminal_(isatty(STDERR_FILENO) == 1) {}

bool LineSchedule::due(double seconds) {
  if (seconds < next_) return false;
  next_ = std::floor(seconds / 60) * 60 + 60;
  return true;
}

void ProgressBar::show(double fraction, const std::string& detail) {
  const auto now = Clock::now();
  if (!is_terminal_) {
    if (lines_.due(Seconds(now - start_).count()))
      fmt::print(stderr, "{}: {:.0f} %, {}\n", title_, 100 * std::clamp(fraction, 0.0, 1.0),
                 detail);
    return;
  }
  if (drawn_ && now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  drawn_ = true;
  fraction = std::clamp(fraction, 0.0, 1.0);
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  constexpr int width = 24;
  const int filled = static_cast<int>(fraction * width);
  std::string bar(static_cast<std::size_t>(filled), '#');
  bar.resize(width, '.');
  const std::string left =
      fraction > 0.005 ? duration_text(elapsed * (1 - fraction) / fraction) + " left" : "";
  fmt::print(stderr, "\r\033[K{} [{}] {:3.0f} %  {}  {}", title_, bar, 100 * fraction, detail,
             left);
  std::fflush(stderr);
}

void ProgressBar::finish() {
  if (!drawn_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

Waiting::Waiting(std::string what) : what_(std::move(what)), thread_([this] { watch(); }) {}

Waiting::~Waiting() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  over_.notify_all();
  thread_.join();
}

void Waiting::watch() {
  const bool is_terminal = isatty(STDERR_FILENO) == 1;
  const auto start = std::chrono::steady_clock::now();
  LineSchedule lines;
  bool drawn = false;
  std::unique_lock lock(mutex_);
  while (!over_.wait_for(lock, std::chrono::milliseconds(500), [this] { return is_over_; })) {
    const double seconds = Seconds(std::chrono::steady_clock::now() - start).count();
    if (is_terminal && seconds >= 2) {
      fmt::print(stderr, "\r\033[K{}, {:.0f} s", what_, seconds);
      std::fflush(stderr);
      drawn = true;
    } else if (lines.due(seconds)) {
      fmt::print(stderr, "{}, {:.0f} s\n", what_, seconds);
    }
  }
  if (drawn) fmt::print(stderr, "\r\033[K");
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(std::max(0.0, seconds)));
  if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
  if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} s", whole);
}

}  // namespace firn::cli

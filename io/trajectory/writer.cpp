// SPDX-License-Identifier: BSD-3-Clause
#include "io/trajectory/writer.hpp"

#include <algorithm>
#include <cstdio>
#include <system_error>
#include <utility>

#include "firn/error.hpp"
#include "io/output_error.hpp"
#include "io/trajectory/file.hpp"
#include "io/trajectory/reader.hpp"

namespace firn {

namespace {

std::string gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g GB", bytes / 1e9);
  return text;
}

/// Refuses early, and in words, what posix_fallocate would refuse.
void require_space(const std::filesystem::path& output, double bytes) {
  std::error_code error;
  const std::filesystem::path folder =
      output.has_parent_path() ? output.parent_path() : std::filesystem::path(".");
  const auto space = std::filesystem::space(folder, error);
  if (error) throw InputError(output.string() + ": cannot be created: " + error.message());
  if (bytes > static_cast<double>(space.available))
    throw InputError(output.string(), "size of the trajectory", gigabytes(bytes),
                     "at most the " + gigabytes(static_cast<double>(space.available)) +
                         " free on that disk (reduce frames_per_second or the end time)");
}

std::filesystem::path with_suffix(std::filesystem::path path, const char* suffix) {
  path += suffix;
  return path;
}

}  // namespace

TrajectoryWriter::TrajectoryWriter(std::filesystem::path output, TrajectoryInfo info,
                                   std::int64_t particles, std::size_t restart_size,
                                   std::int64_t frames, std::int64_t rows)
    : output_(std::move(output)), info_(std::move(info)) {
  const TrajectorySize size{particles, restart_size, std::max<std::int64_t>(frames, 1), rows};
  resolve_output();
  require_space(output_, size.bytes(info_.precision));
  current_ = partial_path();
  try {
    file_ = std::make_unique<TrajectoryFile>(current_, info_, size);
  } catch (const OutputError& error) {
    throw InputError(error.what());
  }
}

/// A symbolic link keeps its place, what it points to is replaced. A device or
/// a pipe would be replaced by a file, so these are refused.
void TrajectoryWriter::resolve_output() {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::canonical(output_, error);
  if (error) return;  // there is nothing yet
  if (!std::filesystem::is_regular_file(target, error))
    throw InputError(
        output_.string(), "output",
        std::filesystem::is_directory(target, error) ? "a directory" : "not a plain file",
        "a new or existing plain file");
  output_ = target;
}

TrajectoryWriter::~TrajectoryWriter() {
  file_.reset();
  if (current_ != output_) std::remove(current_.c_str());
}

/// There are two such names, for a file may have to grow before it is published.
std::filesystem::path TrajectoryWriter::partial_path() const {
  const std::filesystem::path first = with_suffix(output_, ".partial");
  return current_ == first ? with_suffix(output_, ".partial2") : first;
}

void TrajectoryWriter::copy_from(const TrajectoryReader& source,
                                 const std::vector<std::int64_t>& frames, std::int64_t rows) {
  const std::vector<DiagnosticsRow> diagnostics = source.diagnostics();
  waiting_.insert(waiting_.end(), diagnostics.begin(), diagnostics.begin() + rows);
  for (const std::int64_t frame : frames)
    append_frame(source.read_frame(frame), source.restart(frame));
}

void TrajectoryWriter::add_row(const DiagnosticsRow& row) { waiting_.push_back(row); }

void TrajectoryWriter::forget_rows_after(std::int64_t step) {
  const auto keep = static_cast<std::size_t>(std::max<std::int64_t>(step - rows_, 0));
  if (keep < waiting_.size()) waiting_.resize(keep);
}

void TrajectoryWriter::write_frame(const State& state, std::span<const std::byte> restart) {
  append_frame(state, restart);
  if (current_ != output_) publish();
}

void TrajectoryWriter::append_frame(const State& state, std::span<const std::byte> restart) {
  if (!file_) throw OutputError(output_.string() + ": is closed");
  make_room();
  const std::int64_t rows = rows_ + static_cast<std::int64_t>(waiting_.size());
  file_->write_rows(rows_, waiting_);
  file_->write_frame(frames_, state, restart);
  file_->flush();
  if (rows != rows_) file_->count_rows(rows);
  file_->count_frames(frames_ + 1, state.time);
  waiting_.clear();
  rows_ = rows;
  ++frames_;
}

/// Doubles what is full. Frames of a run are counted beforehand; rows are not
/// where the time step is adaptive.
void TrajectoryWriter::make_room() {
  TrajectorySize size = file_->size();
  const std::int64_t rows = rows_ + static_cast<std::int64_t>(waiting_.size());
  if (frames_ < size.frames && rows <= size.rows) return;
  if (frames_ >= size.frames) size.frames *= 2;
  if (rows > size.rows) size.rows = 2 * rows;
  move_to_file_of(size);
}

/// Copies what is complete to a file of another size, which takes the place of
/// the present one. If that fails, the present one stays as it is, closed.
void TrajectoryWriter::move_to_file_of(const TrajectorySize& size) {
  file_.reset();
  const std::filesystem::path path = partial_path();
  try {
    auto copy = std::make_unique<TrajectoryFile>(path, info_, size);
    if (frames_ > 0) copy_complete_part(TrajectoryReader(current_), *copy);
    file_ = std::move(copy);
  } catch (...) {
    std::remove(path.c_str());
    throw;
  }
  const std::filesystem::path old = std::exchange(current_, path);
  if (old == output_)
    publish();
  else
    std::remove(old.c_str());
}

void TrajectoryWriter::copy_complete_part(const TrajectoryReader& from, TrajectoryFile& to) const {
  to.write_rows(0, from.diagnostics());
  to.count_rows(rows_);
  for (std::int64_t frame = 0; frame < frames_; ++frame) {
    to.write_frame(frame, from.read_frame_unchecked(frame), from.restart(frame));
    to.count_frames(frame + 1, from.time(frame));
  }
}

void TrajectoryWriter::publish() {
  file_->sync();
  std::error_code error;
  std::filesystem::rename(current_, output_, error);
  if (error) throw OutputError(output_.string() + ": cannot replace this file: " + error.message());
  current_ = output_;
}

void TrajectoryWriter::finish() {
  if (!file_) return;
  if (frames_ > 0 && current_ != output_) publish();
  TrajectorySize size = file_->size();
  if (frames_ > 0 && (size.frames != frames_ || size.rows != rows_)) {
    size.frames = frames_;
    size.rows = rows_;
    try {
      move_to_file_of(size);
    } catch (const std::exception&) {
      // No room for a copy, even a smaller one.
    }
  }
  file_.reset();
}

}  // namespace firn

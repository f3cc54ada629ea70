// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/resume.hpp"

#include "firn/error.hpp"
#include "firn/registry.hpp"

namespace firn {

namespace {

void require_same_origin(const TrajectoryReader& file, const Scene& scene, const Solver& solver) {
  const std::string where = file.path().string();
  const std::string hint = "; to start anew from any file, use a body of shape \"particles\"";
  if (!file.info()) throw InputError(where + ": has no group /firn and cannot be resumed" + hint);
  const TrajectoryInfo& info = *file.info();
  const SolverTraits& traits = solver.traits();
  if (info.solver != traits.name)
    throw InputError(where, "solver to resume with", traits.name,
                     info.solver + ", which wrote the file" + hint);
  if (info.precision != traits.precision)
    throw InputError(where, "precision to resume with", std::string(name(traits.precision)),
                     std::string(name(info.precision)) + ", as in the file" + hint);
  if (info.scene != scene.toml)
    throw InputError(where, "scene to resume", "a different or changed scene",
                     "the scene in the file (--until and --steps extend the run)" + hint);
}

}  // namespace

Resume::Resume(const std::filesystem::path& path, std::optional<std::int64_t> frame,
               const Scene& scene, const Solver& solver)
    : file_(path) {
  require_same_origin(file_, scene, solver);
  frame_ = frame.value_or(file_.frames() - 1);
  time_ = file_.time(frame_);
  const std::string where = path.string() + ": frame " + std::to_string(frame_);
  if (!file_.step(frame_)) throw InputError(where + ": the file has no /firn/steps");
  step_ = *file_.step(frame_);
  if (step_ > file_.rows())
    throw InputError(where, "steps made", std::to_string(step_),
                     "at most the " + std::to_string(file_.rows()) + " diagnostics rows");
  if (step_ == 0) return;
  const std::vector<DiagnosticsRow> rows = file_.diagnostics();
  const auto last = static_cast<std::size_t>(step_ - 1);
  if (rows[last].time != time_)
    throw InputError(where, "time", to_text(time_),
                     to_text(rows[last].time) + ", that of its diagnostics row");
  previous_time_ = step_ > 1 ? rows[last - 1].time : 0;
}

LastGoodState Resume::read(const Scene& scene) const {
  LastGoodState start;
  start.state = file_.read_frame(frame_);
  start.restart = file_.restart(frame_);
  for (const std::int32_t material : start.state.particles.material)
    if (material < 0 || static_cast<std::size_t>(material) >= scene.materials.size())
      throw InputError(file_.path().string() + ": frame " + std::to_string(frame_), "material",
                       std::to_string(material),
                       "one of the scene's " + std::to_string(scene.materials.size()));
  return start;
}

bool Resume::keeps_its_frame(const FrameSchedule& schedule) const {
  return step_ == 0 || schedule.frame_due(step_, previous_time_, time_);
}

std::vector<std::int64_t> Resume::frames_to_keep(const FrameSchedule& schedule) const {
  std::vector<std::int64_t> frames;
  for (std::int64_t k = 0; k < frame_; ++k) frames.push_back(k);
  if (keeps_its_frame(schedule)) frames.push_back(frame_);
  return frames;
}

}  // namespace firn

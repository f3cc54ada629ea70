#include "io/trajectory_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "firn/error.hpp"
#include "firn/registry.hpp"
#include "io/check_particles.hpp"
#include "io/hdf5_read.hpp"

namespace firn {

namespace {

constexpr std::int64_t any = std::numeric_limits<std::int64_t>::max();

/// Where one frame lies in the arrays.
struct Frame {
  double time = 0;
  std::int64_t particles = 0;
  std::int64_t first = 0;  ///< row in Points
};

}  // namespace

struct TrajectoryReader::Open {
  explicit Open(const std::filesystem::path& path) : file(path) {}

  void read_steps();
  void read_firn();
  void open_arrays();
  void open_array(const std::string& name, const std::string& path, hdf5::Kind kind,
                  int components);
  std::int64_t first_row(const std::string& name, std::int64_t frame) const;
  const Frame& at(std::int64_t frame) const;

  template <class Value>
  void read(const std::string& name, std::int64_t frame, Value* values) const {
    arrays.at(name).read(first_row(name, frame), at(frame).particles, values);
  }

  hdf5::InputFile file;
  std::vector<Frame> frames;
  std::map<std::string, hdf5::InputDataset> arrays;          ///< "Points" and those of PointData
  std::map<std::string, std::vector<std::int64_t>> offsets;  ///< Steps/PointDataOffsets
  std::optional<TrajectoryInfo> info;
  std::vector<std::int64_t> steps;
  std::optional<hdf5::InputDataset> restart;
  std::int64_t rows = 0;
};

namespace {

void require_vtkhdf_polydata(const hdf5::InputFile& file) {
  const std::string vtkhdf = "/VTKHDF";
  const std::vector<std::int64_t> version = file.integer_list_attribute(vtkhdf, "Version");
  if (version[0] != 2)
    throw InputError(file.where(vtkhdf) + ": attribute Version", "major version",
                     std::to_string(version[0]), "2");
  const std::string type = file.text_attribute(vtkhdf, "Type");
  if (type != "PolyData")
    throw InputError(file.where(vtkhdf) + ": attribute Type", "kind of data", type, "PolyData");
}

}  // namespace

/// Frames are counted by NSteps; one without a time is not complete.
void TrajectoryReader::Open::read_steps() {
  const std::string steps = "/VTKHDF/Steps/";
  std::int64_t count = file.integer_attribute("/VTKHDF/Steps", "NSteps");
  if (count < 0)
    throw InputError(file.where("/VTKHDF/Steps") + ": attribute NSteps", "number of frames",
                     std::to_string(count), "≥ 0");
  const hdf5::InputDataset values = file.dataset(steps + "Values", hdf5::Kind::real, 1);
  count = std::min(count, values.rows());

  std::vector<double> times(static_cast<std::size_t>(count));
  values.read(0, count, times.data());
  const auto parts = file.integers(steps + "NumberOfParts", count, 1, any);
  const auto part_offsets = file.integers(steps + "PartOffsets", count, 0, any);
  const auto point_offsets = file.integers(steps + "PointOffsets", count, 0, any);
  const std::string points_name = "/VTKHDF/NumberOfPoints";
  const std::int64_t all_parts = file.dataset(points_name, hdf5::Kind::integer, 1).rows();
  const auto points = file.integers(points_name, all_parts, 0, any);

  for (std::size_t k = 0; k < times.size(); ++k) {
    const std::string where = file.where(steps) + "…[" + std::to_string(k) + "]";
    if (!std::isfinite(times[k]))
      throw InputError(where, "time of the frame", to_text(times[k]), "finite");
    if (parts[k] > all_parts || part_offsets[k] > all_parts - parts[k])
      throw InputError(where, "parts of the frame",
                       std::to_string(parts[k]) + " from " + std::to_string(part_offsets[k]),
                       "within the " + std::to_string(all_parts) + " of NumberOfPoints");
    Frame frame{times[k], 0, point_offsets[k]};
    for (std::int64_t part = 0; part < parts[k]; ++part) {
      const std::int64_t more = points[static_cast<std::size_t>(part_offsets[k] + part)];
      if (more > any - frame.particles)
        throw InputError(where, "number of points", "more than 2^63", "less");
      frame.particles += more;
    }
    frames.push_back(frame);
  }
}

void TrajectoryReader::Open::open_array(const std::string& name, const std::string& path,
                                        hdf5::Kind kind, int components) {
  const auto count = static_cast<std::int64_t>(frames.size());
  const std::string offsets_name = "/VTKHDF/Steps/PointDataOffsets/" + name;
  if (name != "Points" && file.has(offsets_name))
    offsets[name] = file.integers(offsets_name, count, 0, any);
  const hdf5::InputDataset& data =
      arrays.emplace(name, file.dataset(path, kind, components)).first->second;
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t first = first_row(name, k), particles = at(k).particles;
    if (particles > data.rows() || first > data.rows() - particles)
      throw InputError(data.where(), "rows of frame " + std::to_string(k),
                       std::to_string(particles) + " from " + std::to_string(first),
                       "within the " + std::to_string(data.rows()) + " rows of the dataset");
  }
}

void TrajectoryReader::Open::open_arrays() {
  open_array("Points", "/VTKHDF/Points", hdf5::Kind::real, 3);
  const std::string data = "/VTKHDF/PointData/";
  for (const ParticleArray& array : real_particle_arrays)
    open_array(array.name, data + array.name, hdf5::Kind::real, array.components);
  for (const std::string name : {"id", "material"})
    open_array(name, data + name, hdf5::Kind::integer, 1);
}

void TrajectoryReader::Open::read_firn() {
  const std::string firn = "/firn";
  if (!file.has(firn)) return;
  const std::string format = file.text_attribute(firn, "format");
  if (format != trajectory_format)
    throw InputError(file.where(firn) + ": attribute format", "format", format,
                     std::string(trajectory_format));
  const std::int64_t version = file.integer_attribute(firn, "version");
  if (version != trajectory_version)
    throw InputError(file.where(firn) + ": attribute version", "version", std::to_string(version),
                     std::to_string(trajectory_version));
  TrajectoryInfo found;
  found.solver = file.text_attribute(firn, "solver");
  const std::string precision = file.text_attribute(firn, "precision");
  if (precision != "double" && precision != "float")
    throw InputError(file.where(firn) + ": attribute precision", "precision", precision,
                     "double, float");
  found.precision = precision == "float" ? Precision::float32 : Precision::float64;
  found.threads = static_cast<int>(
      std::clamp<std::int64_t>(file.integer_attribute(firn, "threads"), 0, 1 << 20));
  found.firn_version = file.text_attribute(firn, "firn_version");
  found.processor = file.text_attribute(firn, "processor");
  found.scene = file.text_attribute(firn, "scene");
  info = found;

  const auto count = static_cast<std::int64_t>(frames.size());
  if (file.has("/firn/steps")) steps = file.integers("/firn/steps", count, 0, any);
  if (file.has("/firn/restart")) {
    restart = file.dataset("/firn/restart", hdf5::Kind::integer, 0);
    if (restart->rows() < count)
      throw InputError(restart->where(), "number of rows", std::to_string(restart->rows()),
                       "at least the " + std::to_string(count) + " frames");
  }
  if (!file.has("/firn/diagnostics")) return;
  rows = file.integer_attribute("/firn/diagnostics", "rows");
  for (const DiagnosticsColumn& column : diagnostics_columns) {
    const hdf5::InputDataset data =
        file.dataset(std::string("/firn/diagnostics/") + column.name,
                     column.integer ? hdf5::Kind::integer : hdf5::Kind::real, column.components);
    if (rows < 0 || rows > data.rows())
      throw InputError(file.where("/firn/diagnostics") + ": attribute rows", "number of rows",
                       std::to_string(rows),
                       "0 … " + std::to_string(data.rows()) + ", the length of " + column.name);
  }
}

std::int64_t TrajectoryReader::Open::first_row(const std::string& name, std::int64_t frame) const {
  const auto found = offsets.find(name);
  return found == offsets.end() ? at(frame).first : found->second[static_cast<std::size_t>(frame)];
}

const Frame& TrajectoryReader::Open::at(std::int64_t frame) const {
  const auto count = static_cast<std::int64_t>(frames.size());
  if (frame < 0 || frame >= count)
    throw InputError(
        file.path().string(), "frame", std::to_string(frame),
        count == 0 ? "none, the file has no frames" : "0 … " + std::to_string(count - 1));
  return frames[static_cast<std::size_t>(frame)];
}

TrajectoryReader::TrajectoryReader(std::filesystem::path path)
    : open_(std::make_unique<Open>(path)) {
  require_vtkhdf_polydata(open_->file);
  open_->read_steps();
  open_->open_arrays();
  open_->read_firn();
}

TrajectoryReader::~TrajectoryReader() = default;
TrajectoryReader::TrajectoryReader(TrajectoryReader&&) noexcept = default;

const std::filesystem::path& TrajectoryReader::path() const { return open_->file.path(); }

std::int64_t TrajectoryReader::frames() const {
  return static_cast<std::int64_t>(open_->frames.size());
}

std::int64_t TrajectoryReader::particles(std::int64_t frame) const {
  return open_->at(frame).particles;
}

double TrajectoryReader::time(std::int64_t frame) const { return open_->at(frame).time; }

std::optional<std::int64_t> TrajectoryReader::step(std::int64_t frame) const {
  open_->at(frame);
  if (open_->steps.empty()) return std::nullopt;
  return open_->steps[static_cast<std::size_t>(frame)];
}

State TrajectoryReader::read_frame_unchecked(std::int64_t frame) const {
  State state;
  state.time = time(frame);
  state.step = step(frame).value_or(0);
  Particles& p = state.particles;
  p.resize(static_cast<std::size_t>(particles(frame)));
  if (p.size() == 0) return state;
  open_->read("Points", frame, p.x[0].data());
  open_->read("velocity", frame, p.v[0].data());
  open_->read("mass", frame, p.m.data());
  open_->read("volume", frame, p.V_0.data());
  open_->read("F_E", frame, p.F_E[0].data());
  open_->read("F_P", frame, p.F_P[0].data());
  for (Mat3& F : p.F_E) F.transposeInPlace();  // the file is row-major, Mat3 column-major
  for (Mat3& F : p.F_P) F.transposeInPlace();
  open_->read("id", frame, p.id.data());

  std::vector<std::int64_t> material(p.size());
  open_->read("material", frame, material.data());
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (material[i] < 0 || material[i] > std::numeric_limits<std::int32_t>::max())
      throw InputError(open_->arrays.at("material").where() + ", frame " + std::to_string(frame) +
                           ", particle " + std::to_string(i),
                       "material", std::to_string(material[i]), "0 … 2147483647");
    p.material[i] = static_cast<std::int32_t>(material[i]);
  }
  return state;
}

State TrajectoryReader::read_frame(std::int64_t frame) const {
  State state = read_frame_unchecked(frame);
  check_particles(state.particles, path().string() + ": frame " + std::to_string(frame));
  return state;
}

std::vector<std::byte> TrajectoryReader::restart(std::int64_t frame) const {
  open_->at(frame);
  if (!open_->restart) return {};
  std::vector<std::byte> bytes(static_cast<std::size_t>(open_->restart->components()));
  open_->restart->read(frame, 1, bytes.data());
  return bytes;
}

const std::optional<TrajectoryInfo>& TrajectoryReader::info() const { return open_->info; }

std::int64_t TrajectoryReader::rows() const { return open_->rows; }

std::vector<Diagnostics> TrajectoryReader::diagnostics() const {
  std::vector<Diagnostics> rows(static_cast<std::size_t>(open_->rows));
  std::vector<double> values;
  for (std::size_t c = 0; c < diagnostics_columns.size() && !rows.empty(); ++c) {
    const DiagnosticsColumn& column = diagnostics_columns[c];
    const auto components = static_cast<std::size_t>(column.components);
    values.resize(rows.size() * components);
    open_->file
        .dataset(std::string("/firn/diagnostics/") + column.name,
                 column.integer ? hdf5::Kind::integer : hdf5::Kind::real, column.components)
        .read(0, open_->rows, values.data());
    for (std::size_t r = 0; r < rows.size(); ++r) set_column(rows[r], c, &values[r * components]);
  }
  return rows;
}

Particles read_last_frame(const std::filesystem::path& path) {
  const TrajectoryReader reader(path);
  return reader.read_frame(reader.frames() - 1).particles;
}

}  // namespace firn

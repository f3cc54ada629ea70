#include <cmath>
#include <sstream>

#include "firn/error.hpp"
#include "io/scene/scene_file.hpp"

namespace firn {

namespace {

/// A TOML basic string. Names hold no control characters: TomlTable::text() saw to it.
std::string quoted(const std::string& text) {
  std::string quoted(1, '"');
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  quoted += '"';
  return quoted;
}

/// A TOML float: to_text(-0.0) is "-0", which TOML would read as the integer 0.
std::string number(double value) {
  if (std::isinf(value)) return "\"inf\"";
  const std::string text = to_text(value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string vector(const Vec3& v) {
  std::ostringstream out;
  out << '[' << number(v.x()) << ", " << number(v.y()) << ", " << number(v.z()) << ']';
  return out.str();
}

struct ShapeWriter {
  std::ostream& out;

  void operator()(const Sphere& s) const {
    out << "{ type = \"sphere\", center = " << vector(s.center) << ", radius = " << number(s.radius)
        << " }";
  }
  void operator()(const Box& b) const {
    out << "{ type = \"box\", min = " << vector(b.min) << ", max = " << vector(b.max) << " }";
  }
  void operator()(const Cylinder& c) const {
    out << "{ type = \"cylinder\", center = " << vector(c.center) << ", axis = " << vector(c.axis)
        << ", radius = " << number(c.radius) << ", height = " << number(c.height) << " }";
  }
  void operator()(const HalfSpace& s) const {
    out << "{ type = \"half-space\", point = " << vector(s.point)
        << ", normal = " << vector(s.normal) << " }";
  }
  void operator()(const SampledShape&) const {
    throw InputError("scene", "a sampled shape", "one that no file was named for",
                     "a shape read from a mesh or level-set file");
  }
};

void write(std::ostream& out, const Shape& shape) { std::visit(ShapeWriter{out}, shape); }

void write(std::ostream& out, const GridSettings& grid) {
  out << "\n[grid]\nspacing = " << number(grid.spacing) << "\norigin = " << vector(grid.origin)
      << "\nperiodic = " << vector(grid.periodic) << '\n';
}

void write(std::ostream& out, const TimeSettings& time) {
  out << "\n[time]\nend = " << number(time.end) << '\n';
  if (time.adaptive) {
    out << "max_step = " << number(time.max_step) << "\ncfl = " << number(time.cfl)
        << "\nelastic_cfl = " << number(time.elastic_cfl) << '\n';
  } else {
    out << "step = " << number(time.step) << '\n';
  }
  out << "frames_per_second = " << number(time.frames_per_second) << '\n';
}

void write(std::ostream& out, const IntegratorSettings& integrator) {
  const bool semi_implicit = integrator.type == IntegratorType::semi_implicit;
  out << "\n[integrator]\ntype = " << (semi_implicit ? "\"semi-implicit\"" : "\"explicit\"")
      << "\nimplicitness = " << number(integrator.implicitness)
      << "\ntolerance = " << number(integrator.tolerance)
      << "\nmax_iterations = " << integrator.max_iterations << '\n';
}

void write(std::ostream& out, const Material& material) {
  out << "\n[[material]]\nname = " << quoted(material.name)
      << "\nyoungs_modulus = " << number(material.youngs_modulus)
      << "\npoisson_ratio = " << number(material.poisson_ratio)
      << "\ndensity = " << number(material.density)
      << "\nhardening = " << number(material.hardening)
      << "\ncritical_compression = " << number(material.critical_compression)
      << "\ncritical_stretch = " << number(material.critical_stretch) << '\n';
}

std::string_view sampling_name(Sampling sampling) {
  return sampling == Sampling::lattice    ? "lattice"
         : sampling == Sampling::jittered ? "jittered"
                                          : "poisson";
}

void write(std::ostream& out, const Body& body, const Scene& scene) {
  const auto& material = scene.materials.at(static_cast<std::size_t>(body.material));
  out << "\n[[body]]\nmaterial = " << quoted(material.name) << "\nshape = ";
  write(out, body.shape);
  out << "\nparticles_per_cell = " << body.particles_per_cell << "\nsampling = \""
      << sampling_name(body.sampling) << "\"\nseed = " << body.seed
      << "\nvolumes = " << (body.volumes == VolumeSource::exact ? "\"exact\"" : "\"estimated\"")
      << "\nvelocity = " << vector(body.velocity)
      << "\nangular_velocity = " << vector(body.angular_velocity) << '\n';
}

void write(std::ostream& out, const Collider& collider) {
  out << "\n[[collider]]\nshape = ";
  write(out, collider.shape);
  out << "\ninside = " << (collider.inside ? "true" : "false") << '\n';
  if (collider.sticky)
    out << "sticky = true\n";
  else
    out << "friction = " << number(collider.friction) << '\n';
  out << "velocity = " << vector(collider.velocity)
      << "\nangular_velocity = " << vector(collider.angular_velocity)
      << "\ncenter = " << vector(collider.center) << '\n';
}

}  // namespace

std::string resolved_toml(const Scene& scene) {
  std::ostringstream out;
  out << "name = " << quoted(scene.name) << "\ngravity = " << vector(scene.gravity) << '\n';
  write(out, scene.grid);
  write(out, scene.time);
  write(out, scene.integrator);
  out << "\n[transfer]\nflip = " << number(scene.flip) << '\n';
  for (const Material& material : scene.materials) write(out, material);
  for (const Body& body : scene.bodies) write(out, body, scene);
  for (const Collider& collider : scene.colliders) write(out, collider);
  return out.str();
}

}  // namespace firn

// SPDX-License-Identifier: BSD-3-Clause
#include <sstream>

#include "firn/error.hpp"
#include "io/scene/scene_file.hpp"
#include "io/scene/toml_text.hpp"

namespace firn {

namespace {

struct ShapeWriter {
  std::ostream& out;

  void operator()(const Sphere& s) const {
    out << "{ type = \"sphere\", center = " << toml_vector(s.center)
        << ", radius = " << toml_number(s.radius) << " }";
  }
  void operator()(const Box& b) const {
    out << "{ type = \"box\", min = " << toml_vector(b.min) << ", max = " << toml_vector(b.max)
        << " }";
  }
  void operator()(const Cylinder& c) const {
    out << "{ type = \"cylinder\", center = " << toml_vector(c.center)
        << ", axis = " << toml_vector(c.axis) << ", radius = " << toml_number(c.radius)
        << ", height = " << toml_number(c.height) << " }";
  }
  void operator()(const HalfSpace& s) const {
    out << "{ type = \"half-space\", point = " << toml_vector(s.point)
        << ", normal = " << toml_vector(s.normal) << " }";
  }
  void operator()(const SampledShape& s) const { write_source(s.source); }
  void operator()(const SolidShape& s) const { write_source(s.source); }

  void write_source(const std::string& source) const {
    if (source.empty())
      throw InputError("scene", "a shape from a file", "one made in memory",
                       "one read from a file");
    out << source;
  }
};

void write(std::ostream& out, const Shape& shape) { std::visit(ShapeWriter{out}, shape); }

void write(std::ostream& out, const GridSettings& grid) {
  out << "\n[grid]\nspacing = " << toml_number(grid.spacing)
      << "\norigin = " << toml_vector(grid.origin) << "\nperiodic = " << toml_vector(grid.periodic)
      << '\n';
}

void write(std::ostream& out, const TimeSettings& time) {
  out << "\n[time]\nend = " << toml_number(time.end) << '\n';
  if (time.adaptive) {
    out << "max_step = " << toml_number(time.max_step) << "\ncfl = " << toml_number(time.cfl)
        << "\nelastic_cfl = " << toml_number(time.elastic_cfl) << '\n';
  } else {
    out << "step = " << toml_number(time.step) << '\n';
  }
  out << "frames_per_second = " << toml_number(time.frames_per_second) << '\n';
}

void write(std::ostream& out, const IntegratorSettings& integrator) {
  const bool semi_implicit = integrator.type == IntegratorType::semi_implicit;
  out << "\n[integrator]\ntype = " << (semi_implicit ? "\"semi-implicit\"" : "\"explicit\"")
      << "\nimplicitness = " << toml_number(integrator.implicitness)
      << "\ntolerance = " << toml_number(integrator.tolerance)
      << "\nmax_iterations = " << integrator.max_iterations << '\n';
}

void write(std::ostream& out, const Material& material) {
  out << "\n[[material]]\nname = " << toml_string(material.name)
      << "\nyoungs_modulus = " << toml_number(material.youngs_modulus)
      << "\npoisson_ratio = " << toml_number(material.poisson_ratio)
      << "\ndensity = " << toml_number(material.density)
      << "\nhardening = " << toml_number(material.hardening)
      << "\ncritical_compression = " << toml_number(material.critical_compression)
      << "\ncritical_stretch = " << toml_number(material.critical_stretch) << '\n';
}

std::string_view sampling_name(Sampling sampling) {
  return sampling == Sampling::lattice    ? "lattice"
         : sampling == Sampling::jittered ? "jittered"
                                          : "poisson";
}

void write_sampling(std::ostream& out, const Body& body) {
  out << "\nparticles_per_cell = " << body.particles_per_cell << "\nsampling = \""
      << sampling_name(body.sampling) << "\"\nseed = " << body.seed
      << "\nvolumes = " << (body.volumes == VolumeSource::exact ? "\"exact\"" : "\"estimated\"");
}

void write(std::ostream& out, const Body& body, const Scene& scene) {
  const bool from_file = body.sampling == Sampling::from_file;
  if (from_file && body.file.empty())
    throw InputError("scene", "a body of particles", "one made in memory", "one read from a file");
  out << "\n[[body]]\nmaterial = "
      << toml_string(scene.materials.at(static_cast<std::size_t>(body.material)).name)
      << "\nshape = ";
  if (from_file) {
    out << "{ type = \"particles\", file = " << toml_string(body.file) << " }";
  } else {
    write(out, body.shape);
    write_sampling(out, body);
  }
  out << "\nvelocity = " << toml_vector(body.velocity);
  if (!from_file) out << "\nangular_velocity = " << toml_vector(body.angular_velocity);
  out << '\n';
}

void write(std::ostream& out, const Collider& collider) {
  out << "\n[[collider]]\nshape = ";
  write(out, collider.shape);
  out << "\ninside = " << (collider.inside ? "true" : "false") << '\n';
  if (collider.sticky)
    out << "sticky = true\n";
  else
    out << "friction = " << toml_number(collider.friction) << '\n';
  out << "velocity = " << toml_vector(collider.velocity)
      << "\nangular_velocity = " << toml_vector(collider.angular_velocity)
      << "\ncenter = " << toml_vector(collider.center) << '\n';
}

}  // namespace

std::string resolved_toml(const Scene& scene) {
  std::ostringstream out;
  out << "name = " << toml_string(scene.name) << "\ngravity = " << toml_vector(scene.gravity)
      << '\n';
  write(out, scene.grid);
  write(out, scene.time);
  write(out, scene.integrator);
  out << "\n[transfer]\nflip = " << toml_number(scene.flip) << '\n';
  for (const Material& material : scene.materials) write(out, material);
  for (const Body& body : scene.bodies) write(out, body, scene);
  for (const Collider& collider : scene.colliders) write(out, collider);
  return out.str();
}

}  // namespace firn

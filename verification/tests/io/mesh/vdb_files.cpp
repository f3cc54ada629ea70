// SPDX-License-Identifier: BSD-3-Clause
#include "verification/tests/io/mesh/vdb_files.hpp"

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

namespace firn {

namespace {

using openvdb::FloatGrid;

FloatGrid::Ptr sphere(const Vec3& center, double radius, double s) {
  openvdb::initialize();
  const auto volume = openvdb::tools::createLevelSetSphere<FloatGrid>(
      static_cast<float>(radius), openvdb::Vec3f(openvdb::Vec3d(center[0], center[1], center[2])),
      static_cast<float>(s));
  volume->setName("sphere");
  return volume;
}

FloatGrid::Ptr fog() {
  openvdb::initialize();
  const auto volume = FloatGrid::create(0.0f);
  volume->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(3)), 1.0f);
  volume->setGridClass(openvdb::GRID_FOG_VOLUME);
  volume->setName("fog");
  return volume;
}

void write(const std::string& path, const openvdb::GridPtrVec& grids) {
  openvdb::io::File(path).write(grids);
}

}  // namespace

void write_vdb_sphere(const std::string& path, const Vec3& center, double radius, double s) {
  write(path, {sphere(center, radius, s)});
}

void write_vdb_fog_and_sphere(const std::string& path, double radius, double s) {
  write(path, {fog(), sphere(Vec3::Zero(), radius, s)});
}

void write_vdb_named(const std::string& path, double radius, double s) {
  const auto ball = sphere(Vec3::Zero(), radius, s), pearl = sphere(Vec3::Zero(), radius / 2, s);
  const auto mist = fog();
  ball->setName("ball");
  pearl->setName("pearl");
  mist->setName("mist");
  write(path, {mist, ball, pearl});
}

void write_vdb_with_value(const std::string& path, double radius, double s, int i, float value) {
  const auto volume = sphere(Vec3::Zero(), radius, s);
  volume->tree().setValue(openvdb::Coord(i, 0, 0), value);
  write(path, {volume});
}

void write_vdb_unflooded(const std::string& path, double radius, double s) {
  const auto whole = sphere(Vec3::Zero(), radius, s);
  const auto volume = FloatGrid::create(whole->background());
  volume->setTransform(whole->transform().copy());
  volume->setGridClass(openvdb::GRID_LEVEL_SET);
  for (auto value = whole->cbeginValueOn(); value; ++value)
    volume->tree().setValue(value.getCoord(), *value);
  write(path, {volume});
}

void write_vdb_fog(const std::string& path) { write(path, {fog()}); }

void write_vdb_stretched(const std::string& path) {
  const auto volume = sphere(Vec3::Zero(), 1, 0.25);
  const auto transform = openvdb::math::Transform::createLinearTransform();
  transform->preScale(openvdb::Vec3d(0.25, 0.25, 0.5));
  volume->setTransform(transform);
  write(path, {volume});
}

void write_vdb_turned(const std::string& path) {
  const auto volume = sphere(Vec3::Zero(), 1, 0.25);
  const auto transform = openvdb::math::Transform::createLinearTransform(0.25);
  transform->preRotate(0.3, openvdb::math::Z_AXIS);
  volume->setTransform(transform);
  write(path, {volume});
}

void write_vdb_empty(const std::string& path) {
  openvdb::initialize();
  const auto volume = FloatGrid::create(0.75f);
  volume->setGridClass(openvdb::GRID_LEVEL_SET);
  write(path, {volume});
}

}  // namespace firn

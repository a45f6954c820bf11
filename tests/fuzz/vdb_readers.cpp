// Bones, spines and points in .vdb files, ours and those of other programs.

#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/base/error.h"
#include "tests/fuzz/readers.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/cut_hole.h"
#include "vdb/bake/bake.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"
#include "vdb/detail/vdb_layout.h"
#include "vdb/engine/points_file.h"
#include "vdb/grid/bone_hash.h"
#include "vdb/grid/spine_file.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

/// A bone that another program gave may lie in active tiles of 2^27 voxels: as many floats, and a CT of them.
constexpr std::size_t kMaxGridAllocation = std::size_t{600} << 20;

CtVolume small_ct() {
  GridGeometry geometry;
  geometry.size = {16, 16, 30};
  geometry.spacing_mm = Vec3::Constant(0.5);
  geometry.origin_mm = Vec3(-2.5, -6.5, -0.5);
  std::vector<std::int16_t> hu;
  for (std::size_t i = 0; i < geometry.voxel_count(); ++i) hu.push_back(static_cast<std::int16_t>(i * 37 % 2048));
  return make_ct_volume(geometry, std::move(hu));
}

BoneModel ball_of(double z_mm, Level level) {
  const Ball ball{Vec3(1.5, -2.5, z_mm), 2.0};
  const CtVolume ct = small_ct();
  return bake_bone(ball.field(), ball.surface_points(1.0), ct, {},
                   {{"method", "ball"}, {"source_hash", ct.source_hash}, {"level", level_name(level)}});
}

/// Puts the checksum of a changed file right again, so that what comes after it is read.
std::string sealed(const std::string& bytes) {
  std::string copy = bytes;
  try {
    detail::seal_vdb(copy);
  } catch (const Error&) {  // has no place for it any more
  }
  return copy;
}

openvdb::GridPtrVec foreign_grids(const BoneModel& bone) {
  const auto sdf = bone.grids().sdf->deepCopy();
  const auto hu = bone.grids().hu->deepCopy();
  sdf->setName("sdf");
  hu->setName("hu");
  return {sdf, hu};
}

std::vector<Seed> bone_seeds() {
  initialize_openvdb();
  const BoneModel bone = ball_of(3.5, Level::kL1);
  const BoneModel drilled = test::without_hole(bone, DrillBit{1.0, 10.0, 0.5}, {Vec3(1.5, -2.5, 8.0), -Vec3::UnitZ()},
                                               {Vec3(1.5, -2.5, 3.0), -Vec3::UnitZ()});
  const std::vector<SpineBone> bones{
      {Level::kT12, ball_of(9.0, Level::kT12), {{"small"}, 0.25, "{\"frame\": \"LPS\"}", ""}},
      {Level::kL1, bone, {{}, 0.0, "", "no canal"}}};
  std::vector<Seed> seeds;
  const auto add = [&](const char* name, const auto& write) {
    seeds.push_back({name, {{"bone.vdb", bytes_written("bone.vdb", write), sealed}}});
  };
  add("a bone", [&](const fs::path& file) { write_bone(bone, file); });
  add("a drilled bone", [&](const fs::path& file) { write_bone(drilled, file); });
  add("a spine", [&](const fs::path& file) { write_spine(bones, file); });
  for (const std::uint32_t compression : {0U, 1U, 2U, 3U, 6U}) {
    const auto write = [&](const fs::path& file) {
      openvdb::io::File out(file.string());
      out.setCompression(compression);
      out.write(foreign_grids(bone));
      out.close();
    };
    seeds.push_back({"a foreign bone", {{"bone.vdb", bytes_written("bone.vdb", write)}}});
  }
  const auto write_stream = [&](const fs::path& file) {
    std::ofstream out(file, std::ios::binary);
    openvdb::io::Stream(out).write(foreign_grids(drilled));
  };
  seeds.push_back({"a foreign bone without places", {{"bone.vdb", bytes_written("bone.vdb", write_stream)}}});
  return seeds;
}

/// As `info` and the planner look at one.
void use_bone(const BoneModel& bone) {
  static_cast<void>(bone_hash(bone));
  const Box3 box_mm = bone.bounds_mm();
  const std::vector<Vec3> points_mm{box_mm.min(), box_mm.center(), box_mm.max(), Vec3::Zero()};
  std::vector<float> values(points_mm.size());
  std::vector<Vec3> slopes(points_mm.size());
  bone.distance(points_mm, values, slopes, Interpolation::quadratic);
  bone.hu(points_mm, values, slopes, Interpolation::quadratic);
  if (is_drilled(bone)) static_cast<void>(before_drilling(bone).active_voxels());
  // Coarse where damage has made the box vast: it lets 2^28 voxels pass, which take 4 s.
  constexpr double kVoxels = 1e6;
  static_cast<void>(ct_of_bone(bone, std::max(2.0, std::cbrt(box_mm.volume() / kVoxels))));
}

void read_bones(const fs::path& folder) {
  const fs::path file = only_file(folder);
  if (levels_in(file).empty()) {
    use_bone(read_bone(file));
  } else {
    for (const Level level : levels_in(file)) use_bone(read_spine_level(file, level).bone);
  }
}

std::vector<Seed> point_seeds() {
  const DrillPath path{"left \"pedicle\"", Vec3(1234.5, -987.6, 1500.3), Vec3(1235.5, -985.6, 1497.3), {}};
  PointVolume volume(path, {.radius_mm = 0.5, .spacing_mm = 0.2, .jitter = 0.3});
  const auto write = [&](const fs::path& file) { write_points(volume, path, file, {.density = HuToDensity{}}); };
  // Not sealed again: how points are packed is not checked, which is why only sealed ones are read.
  return {{"points", {{"points.vdb", bytes_written("points.vdb", write)}}}};
}

}  // namespace

void add_vdb_readers(std::vector<Reader>& readers) {
  readers.push_back({"bone", bone_seeds, read_bones, kMaxGridAllocation});
  readers.push_back(
      {"saved-points", point_seeds, [](const fs::path& folder) { static_cast<void>(read_points(only_file(folder))); }});
}

}  // namespace spinaltap::test

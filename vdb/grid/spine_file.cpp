#include "vdb/grid/spine_file.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using openvdb::MaskGrid;

constexpr const char* kSourceKey = "spinaltap:source_hash";
/// Before the names of a level's notes, in its `sdf`.
const std::string kNotePrefix = "spinaltap-level:";

std::string sdf_name(Level level) { return "sdf_" + level_name(level); }
std::string part_name(Level level) { return "part_" + level_name(level); }

std::string source_of(const BoneModel& bone) {
  const auto found = bone.metadata().find("source_hash");
  return found == bone.metadata().end() ? "" : found->second;
}

void check_bones(std::span<const SpineBone> bones) {
  if (bones.empty()) fail("spine: expected bones, found none");
  const detail::BoneGrids& first = bones.front().bone.grids();
  std::vector<Level> seen;
  for (const SpineBone& one : bones) {
    const std::string name = level_name(one.level);
    if (name.empty()) fail("spine: expected a level for each bone, found none for bone ", seen.size() + 1);
    if (std::find(seen.begin(), seen.end(), one.level) != seen.end()) fail("spine: found ", name, " twice");
    seen.push_back(one.level);
    if (is_drilled(one.bone)) fail("spine: expected bones as they were baked, found that ", name, " is drilled");
    const openvdb::FloatGrid& hu = *one.bone.grids().hu;
    if (source_of(one.bone) != source_of(bones.front().bone) || hu.transform() != first.hu->transform() ||
        hu.background() != first.hu->background()) {
      fail("spine: expected bones of one CT, found that ", name, " is of another than ",
           level_name(bones.front().level));
    }
    for (const std::string& warning : one.notes.warnings) {
      if (warning.find('\n') != std::string::npos) fail("spine: expected warnings of one line for ", name);
    }
    if (!std::isfinite(one.notes.severity)) fail("spine: expected a number as the severity of ", name);
  }
}

/// All CT numbers. Where bones share voxels, these are the same CT's.
openvdb::FloatGrid::Ptr shared_hu(const std::vector<const SpineBone*>& bones) {
  openvdb::FloatGrid::Ptr hu = bones.front()->bone.grids().hu->deepCopy();
  for (const SpineBone* one : bones) openvdb::tools::compReplace(hu->tree(), one->bone.grids().hu->tree());
  for (const SpineBone* one : bones) {
    const auto shared = hu->getConstAccessor();
    for (auto value = one->bone.grids().hu->cbeginValueOn(); value; ++value) {
      if (shared.getValue(value.getCoord()) != *value) {
        fail("spine: expected bones of one CT, found other CT numbers in ", level_name(one->level));
      }
    }
  }
  hu->setName("hu");
  hu->setSaveFloatAsHalf(detail::fits_half_floats(*hu));
  return hu;
}

/// A copy that shares the voxels, with metadata of its own.
openvdb::FloatGrid::Ptr named_sdf(const SpineBone& one) {
  auto copy = std::const_pointer_cast<openvdb::FloatGrid>(one.bone.grids().sdf)->copy();
  copy->clearMetadata();
  copy->setName(sdf_name(one.level));
  copy->setGridClass(openvdb::GRID_LEVEL_SET);
  copy->setSaveFloatAsHalf(detail::fits_half_floats(*copy));
  detail::add_metadata(one.bone.metadata(), *copy);
  const auto note = [&](const char* name, const std::string& text) {
    if (!text.empty()) copy->insertMeta(kNotePrefix + name, openvdb::StringMetadata(text));
  };
  std::string warnings;
  for (const std::string& warning : one.notes.warnings) warnings += warning + '\n';
  note("warnings", warnings);
  note("landmarks", one.notes.landmarks);
  note("no_landmarks", one.notes.no_landmarks);
  copy->insertMeta(kNotePrefix + "severity", openvdb::DoubleMetadata(one.notes.severity));
  return copy;
}

std::vector<Level> levels_of(const detail::VdbFile& file, const fs::path& path) {
  const auto listed = file.metadata().getMetadata<openvdb::StringMetadata>(detail::kLevelsKey);
  if (!listed) return {};
  std::istringstream names(listed->value());
  std::vector<Level> levels;
  for (std::string name; names >> name;) {
    const std::optional<Level> level = level_from_name(name);
    if (!level || level_name(*level) != name || std::find(levels.begin(), levels.end(), *level) != levels.end()) {
      fail("expected a list of levels in ", path.string(), ", found \"", detail::printable(listed->value()), "\"");
    }
    levels.push_back(*level);
  }
  if (levels.empty()) fail("expected a list of levels in ", path.string(), ", found an empty one");
  return levels;
}

/// The numbers of one bone as they were before they were put together with the others'.
openvdb::FloatGrid::Ptr own_hu(detail::VdbFile& file, Level level, const fs::path& path) {
  const MaskGrid::Ptr part = file.read_mask(part_name(level));
  const openvdb::CoordBBox box = part->evalActiveVoxelBoundingBox();
  const openvdb::FloatGrid::Ptr shared = file.read_floats("hu", &box);
  if (part->transform() != shared->transform()) {
    fail("expected the grid ", part_name(level), " on the voxels of hu in ", path.string());
  }
  const auto tree = std::make_shared<openvdb::FloatTree>(part->tree(), shared->background(), openvdb::TopologyCopy());
  const auto number = shared->getConstAccessor();
  for (auto value = tree->beginValueOn(); value; ++value) {
    // A tile stands for voxels of one number.
    if (!number.isValueOn(value.getCoord())) {
      fail("expected CT numbers for all of ", level_name(level), " in ", path.string(), ", found some missing");
    }
    value.setValue(number.getValue(value.getCoord()));
  }
  auto grid = openvdb::FloatGrid::create(tree);
  grid->setTransform(shared->transform().copy());
  grid->setName("hu");
  return grid;
}

void check_sdf(const openvdb::FloatGrid& sdf, const std::string& name, const fs::path& path) {
  if (sdf.getGridClass() != openvdb::GRID_LEVEL_SET || sdf.activeVoxelCount() == 0 || !sdf.transform().isLinear() ||
      !sdf.hasUniformVoxels()) {
    fail("expected the grid ", name, " to be a level set of cubic voxels that is not empty in ", path.string());
  }
}

LevelNotes notes_of(const openvdb::FloatGrid& sdf) {
  LevelNotes notes;
  const auto text = [&](const char* name) {
    const auto meta = sdf.getMetadata<openvdb::StringMetadata>(kNotePrefix + name);
    return meta ? meta->value() : std::string();
  };
  std::istringstream warnings(text("warnings"));
  for (std::string line; std::getline(warnings, line);) notes.warnings.push_back(line);
  notes.landmarks = text("landmarks");
  notes.no_landmarks = text("no_landmarks");
  const auto severity = sdf.getMetadata<openvdb::DoubleMetadata>(kNotePrefix + "severity");
  if (severity) notes.severity = severity->value();
  return notes;
}

SpineBone read_level(detail::VdbFile& file, Level level, const fs::path& path) {
  auto grids = std::make_shared<detail::BoneGrids>();
  const openvdb::FloatGrid::Ptr sdf = file.read_floats(sdf_name(level));
  check_sdf(*sdf, sdf_name(level), path);
  const openvdb::FloatGrid::Ptr hu = own_hu(file, level, path);
  if (!hu->transform().isLinear()) fail("expected the grid hu without perspective in ", path.string());
  grids->metadata = detail::metadata_of(*sdf, path);
  const LevelNotes notes = notes_of(*sdf);
  sdf->setName("sdf");
  grids->sdf = sdf;
  grids->hu = hu;
  try {
    return {level, BoneModel(grids), notes};
  } catch (const Error& error) {
    fail("cannot read ", path.string(), ": ", error.what());
  }
}

}  // namespace

std::string level_names(std::span<const Level> levels) {
  std::string text;
  for (const Level level : levels) text += (text.empty() ? "" : ", ") + level_name(level);
  return text;
}

void write_spine(std::span<const SpineBone> bones, const fs::path& path) {
  initialize_openvdb();
  check_bones(bones);
  std::vector<const SpineBone*> sorted;
  for (const SpineBone& one : bones) sorted.push_back(&one);
  std::sort(sorted.begin(), sorted.end(),
            [](const auto* a, const auto* b) { return level_rank(a->level) < level_rank(b->level); });
  openvdb::GridCPtrVec grids;
  std::string levels;
  for (const SpineBone* one : sorted) {
    levels += (levels.empty() ? "" : " ") + level_name(one->level);
    grids.push_back(named_sdf(*one));
    const auto part = MaskGrid::create(
        std::make_shared<openvdb::MaskTree>(one->bone.grids().hu->tree(), false, openvdb::TopologyCopy()));
    part->setTransform(one->bone.grids().hu->transform().copy());
    part->setName(part_name(one->level));
    grids.push_back(part);
  }
  grids.push_back(shared_hu(sorted));
  openvdb::MetaMap metadata;
  metadata.insertMeta(detail::kLevelsKey, openvdb::StringMetadata(levels));
  metadata.insertMeta(kSourceKey, openvdb::StringMetadata(source_of(sorted.front()->bone)));
  try {
    detail::write_vdb(path, grids, metadata);
    // OpenVDB does not look whether its last bytes reached the disk; reading them back does.
    detail::VdbFile written(path);
    for (const SpineBone* one : sorted) read_level(written, one->level, path);
  } catch (const std::exception&) {
    fail_as(ErrorKind::disk, "cannot write ", path.filename().string(),
            ": is the disk full, or the folder not writable?");
  }
}

std::vector<Level> levels_in(const fs::path& path) { return levels_of(detail::VdbFile(path), path); }

SpineBone read_spine_level(const fs::path& path, Level level) {
  detail::VdbFile file(path);
  const std::vector<Level> levels = levels_of(file, path);
  if (levels.empty()) fail("expected a file of several bones, found another .vdb: ", path.string());
  if (std::find(levels.begin(), levels.end(), level) == levels.end()) {
    fail("no ", level == Level::kNone ? "level" : level_name(level), " in ", path.string(),
         "; there are: ", level_names(levels));
  }
  return read_level(file, level, path);
}

}  // namespace spinaltap

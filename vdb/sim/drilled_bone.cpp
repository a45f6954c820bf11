#include "vdb/sim/drilled_bone.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/engine/volume_segments.h"
#include "core/session/choose_engine.h"
#include "vdb/engine/make_engine.h"
#include "vdb/engine/occupied_voxels.h"
#include "vdb/engine/voxel_engine.h"
#include "vdb/sim/detail/bone_volumes.h"

namespace spinaltap {
namespace {

void drill_out(DrillEngine& engine, const DrilledHole& hole) {
  for (const std::vector<Pose>& way : hole.ways) {
    engine.reset_motion();
    for (const Pose& pose : way) engine.step(pose);
  }
}

/// What would have no effect is not taken without a word.
void check_for_voxels(const SessionSetup& setup, const ScalarField* exact) {
  const auto reject = [](const char* what) {
    fail_as(ErrorKind::unsupported, "voxels: expected no ", what, ": only engines of points have it");
  };
  if (exact != nullptr) reject("exact surface");
  if (setup.fine_spacing_mm != 0.0) reject("finer spacing near the surface");
  if (setup.volume.jitter != 0.0) reject("jitter");
  if (setup.volume.subdivision != DiscSubdivision::rings) reject("other subdivision of discs");
}

[[noreturn]] void reject_plate(EngineKind engine) {
  fail("a plate: expected the engine voxel, found ", name_of(engine), ", whose points only tools that turn can drill");
}

}  // namespace

DrilledBone::DrilledBone(std::span<const BoneModel> bones, const SessionSetup& setup, const ScalarField* exact,
                         const Progress& progress) {
  if (bones.empty()) fail("expected a bone to drill, found none");
  const EngineKind engine = chosen_engine(setup);
  if (engine == EngineKind::voxel) {
    check_for_voxels(setup, exact);
    VoxelBoneOptions options{.voxel_mm = setup.volume.spacing_mm};
    if (setup.region_mm) {
      check_region(*setup.region_mm);
      options.region_mm = *setup.region_mm;
    }
    voxels = std::make_unique<VoxelBone>(bones, options, progress);
    for (const DrilledHole& hole : setup.holes) drill(hole, setup);
    return;
  }
  if (setup.region_mm) {
    fail("region: expected the engine voxel, found ", name_of(engine), ", whose points fill a cylinder along the path");
  }
  if (bones.size() > 1) {
    fail("several bones: expected the engine voxel, found ", name_of(engine),
         ", whose points fill a cylinder in one bone");
  }
  if (!setup.options.has_path) {
    fail("no path: expected the engine voxel, found ", name_of(engine), ", whose points fill a cylinder along one");
  }
  if (setup.path.bit.is_plate()) reject_plate(engine);
  const BoneModel& bone = bones.front();
  volumes =
      volumes_along(bone, setup.path, setup.volume, {setup.fine_spacing_mm, setup.fine_near_mm, setup.fine_tip_mm});
  for (PointVolume& volume : volumes) fill_volume(volume, sampler_of(bone, exact), progress);
  for (const DrilledHole& hole : setup.holes) drill(hole, setup);
}

DrilledBone::DrilledBone(const DrilledBone& other)
    : volumes(other.volumes), voxels(other.voxels ? std::make_unique<VoxelBone>(*other.voxels) : nullptr) {}

void DrilledBone::drill(const DrilledHole& hole, const SessionSetup& setup) {
  if (voxels) drill_out(*make_voxel_engine(*voxels, hole.bit, setup.material), hole);
  for (PointVolume& volume : volumes) {
    drill_out(*make_engine(chosen_engine(setup), volume, hole.bit, setup.material), hole);
  }
}

void DrilledBone::restore(const DrilledBone& whole) {
  const auto size = [](const PointVolume& volume) { return volume.occupancy_words().size(); };
  if (!voxels != !whole.voxels || !std::ranges::equal(volumes, whole.volumes, {}, size, size)) {
    fail("expected what is drilled to be restored from the bone that it is a copy of");
  }
  if (voxels) return voxels->restore(*whole.voxels);
  set_occupancy_words(whole.occupancy_words());
}

std::vector<std::uint64_t> DrilledBone::occupancy_words() const {
  std::vector<std::uint64_t> words;
  if (voxels) voxels->get_occupancy_words(words);
  for (const PointVolume& volume : volumes) {
    words.insert(words.end(), volume.occupancy_words().begin(), volume.occupancy_words().end());
  }
  return words;
}

void DrilledBone::set_occupancy_words(std::span<const std::uint64_t> words) {
  if (voxels) return voxels->set_occupancy_words(words);
  std::size_t expected = 0;
  for (const PointVolume& volume : volumes) expected += volume.occupancy_words().size();
  if (words.size() != expected) fail("points: expected ", expected, " occupied words, found ", words.size());
  auto from = words.begin();
  for (PointVolume& volume : volumes) {
    for (int disc = 0; disc < volume.disc_count(); ++disc) {
      const auto disc_words = volume.occupancy_words(disc);
      std::copy_n(from, disc_words.size(), disc_words.begin());
      from += static_cast<std::ptrdiff_t>(disc_words.size());
    }
  }
}

std::unique_ptr<DrillEngine> DrilledBone::engine_for(const SessionSetup& setup, const DrillBit& bit) {
  if (voxels) return make_voxel_engine(*voxels, bit, setup.material);
  if (bit.is_plate()) reject_plate(chosen_engine(setup));
  std::vector<std::unique_ptr<DrillEngine>> engines;
  for (PointVolume& volume : volumes) {
    engines.push_back(make_engine(chosen_engine(setup), volume, bit, setup.material));
  }
  return make_joint_engine(std::move(engines));
}

std::unique_ptr<DrillSession> DrilledBone::begin_session(const SessionSetup& setup, const ClearanceField* clearances) {
  const DrillPath& path = setup.path;
  std::unique_ptr<DrillEngine> engine = engine_for(setup, path.bit);
  if (voxels) {
    return std::make_unique<DrillSession>(path, make_occupied_bone(*voxels, setup.material), std::move(engine),
                                          setup.material, clearances, setup.options);
  }
  return std::make_unique<DrillSession>(path, volumes, std::move(engine), setup.material, clearances, setup.options);
}

std::size_t DrilledBone::occupied_count() const {
  std::size_t occupied = voxels ? voxels->occupied_count() : 0;
  for (const PointVolume& volume : volumes) occupied += volume.occupied_count();
  return occupied;
}

std::size_t DrilledBone::memory_bytes() const {
  std::size_t bytes = voxels ? voxels->memory_bytes() : 0;
  for (const PointVolume& volume : volumes) bytes += volume.memory_bytes();
  return bytes;
}

}  // namespace spinaltap

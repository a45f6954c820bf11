#include "apps/spinaltap-planner/opened_bone.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/ct/crop.h"
#include "core/ct/read_ct.h"
#include "core/files/bake_cache.h"
#include "vdb/grid/bone_model.h"
#include "vdb/remaining/remaining_surface.h"
#include "vdb/sim/bake_ct.h"
#include "vdb/sim/label_warnings.h"

namespace spinaltap {

FileKind kind_of_file(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) fail("expected a CT, a bone or a plan, found no ", path.string());
  if (std::filesystem::is_directory(path)) return FileKind::ct;
  if (path.extension() == ".vdb") return FileKind::bone;
  if (path.extension() == ".json") return FileKind::plan;
  return FileKind::ct;
}

namespace {

void add_bone(Bone bone, OpenedBone& opened, const Progress& progress) {
  progress.report("meshing", 0.0);
  RemainingBone remaining(bone.model(), {.voxel_mm = kSurfaceVoxelMm});
  for (const auto& block : RemainingSurface(remaining).blocks()) opened.surface.push_back({block->block, block});
  opened.bone = std::move(bone);
  opened.bone->walls(progress);
  opened.bone->hash();  // autosaves ask for it
  opened.neighbours = neighbours_among(opened.bone->neighbours(), progress);
}

/// The voxels of a label on a grid of which the map's is a part.
BoneMask mask_on(const GridGeometry& grid, const LabelVolume& part, int label) {
  const std::array<int, 3>& size = part.geometry.size;
  const Eigen::Array3i first = grid.to_index(part.geometry.origin_mm).array().round().cast<int>();
  BoneMask mask{grid, std::vector<std::uint8_t>(grid.voxel_count(), 0)};
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      const std::uint8_t* from = part.labels.data() + part.geometry.offset(0, j, k);
      std::uint8_t* to = mask.inside.data() + grid.offset(first.x(), first.y() + j, first.z() + k);
      std::transform(from, from + size[0], to,
                     [label](std::uint8_t one) { return static_cast<std::uint8_t>(one == label); });
    }
  }
  return mask;
}

/// A bone of an opened CT, which shares the CT.
std::shared_ptr<const OpenedBone> with_bone(const OpenedBone& ct, const Vec3& seed_mm, Bone bone,
                                            const std::filesystem::path& cache, const Progress& progress) {
  auto opened = std::make_shared<OpenedBone>(ct.volume);
  opened->file = ct.file;
  opened->options = ct.options;
  opened->options.level = Level::kNone;  // another build may name it otherwise
  opened->options.seed_mm = seed_mm;
  opened->is_whole_ct = true;
  add_bone(std::move(bone), *opened, progress);
  BakeCache(cache).prune(kCacheBytes, kCacheDays);
  return opened;
}

}  // namespace

std::shared_ptr<const OpenedBone> open_bone(const std::filesystem::path& file, const Progress& progress, Level level) {
  progress.report("reading", 0.0);
  Bone bone = Bone::load(file, level);
  progress.report("reading", 0.5);
  auto opened = std::make_shared<OpenedBone>(std::make_shared<const CtVolume>(ct_of_bone(bone.model())));
  opened->file = file;
  opened->options.level = level;
  add_bone(std::move(bone), *opened, progress);
  return opened;
}

std::shared_ptr<const OpenedBone> open_ct(const std::filesystem::path& path, const OpenOptions& options,
                                          const Progress& progress) {
  auto opened =
      std::make_shared<OpenedBone>(std::make_shared<const CtVolume>(read_ct(path, options.reading, progress)));
  opened->file = path;
  opened->options = options;
  opened->is_whole_ct = true;
  return opened;
}

SpineSegmentation find_levels(const OpenedBone& ct, const Progress& progress) {
  SpineSegmentation found = segment_spine(ct.ct, {}, progress);
  if (found.levels.empty()) return found;
  BoneMask labels{found.labels.geometry, std::move(found.labels.labels)};
  labels = crop(labels, block_around(labels, 0.0));
  found.labels.geometry = labels.geometry;
  found.labels.labels = std::move(labels.inside);
  return found;
}

std::shared_ptr<const OpenedBone> bake_level(const OpenedBone& ct, const SpineSegmentation& found,
                                             const LevelReport& level, const std::filesystem::path& cache,
                                             const Progress& progress) {
  MaskStage mask{
      mask_on(ct.ct.geometry, found.labels, level.label),
      joined(level.name, " of ", found.levels.size(), " found; bone from ", found.bone.threshold_hu, " HU on"),
      level.level, warnings_of(level)};
  warn_of_border(mask.mask, *mask.warnings);
  BakeCtOptions options;
  options.cache = cache;
  return with_bone(ct, level.body_centre_mm, Bone(bake_mask(ct.ct, mask, options, progress).bone), cache, progress);
}

std::shared_ptr<const OpenedBone> bake_vertebra_at(const OpenedBone& ct, const Vec3& seed_mm,
                                                   const std::filesystem::path& cache, const Progress& progress) {
  BakeCtOptions options;
  options.segment.seed_mm = seed_mm;
  options.cache = cache;
  return with_bone(ct, seed_mm, Bone(bake_ct(ct.ct, options, progress).bone), cache, progress);
}

Box3 OpenedBone::bounds_mm() const {
  if (bone) return model().bounds_mm();
  Box3 box;
  const GridGeometry& geometry = ct.geometry;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 p_index;
    for (int axis = 0; axis < 3; ++axis) {
      const int last = geometry.size[static_cast<std::size_t>(axis)] - 1;
      p_index[axis] = (corner >> axis & 1) != 0 ? last : 0;
    }
    box.extend(geometry.to_patient(p_index));
  }
  return box;
}

Vec3 stick_to_surface(const OpenedBone& bone, const Vec3& p_mm) {
  if (!p_mm.allFinite()) return p_mm;
  // The samples bring it to about 0.2 mm of the surface, within the distance grid's band; Newton's steps do the rest.
  Vec3 place = bone.bone->walls().outer(p_mm).nearest_mm;
  for (int step = 0; step < 4; ++step) {
    std::array<float, 1> distance_mm{};
    std::array<Vec3, 1> gradient{};
    bone.model().distance(std::array{place}, distance_mm, gradient);
    const double slope = gradient[0].squaredNorm();
    if (!(slope > 1e-6)) break;
    place -= gradient[0] * (distance_mm[0] / slope);
  }
  return place;
}

Vec3 entry_behind(const OpenedBone& bone, const Vec3& target_mm) {
  constexpr double kStepMm = 0.25;
  const Landmarks* landmarks = bone.landmarks();
  const Vec3 back = landmarks != nullptr ? landmarks->posterior() : Vec3::UnitY();
  std::vector<Vec3> points_mm;
  const double far_mm = bone.model().bounds_mm().diagonal().norm();
  for (double way_mm = 0.0; way_mm <= far_mm; way_mm += kStepMm) points_mm.push_back(target_mm + way_mm * back);
  std::vector<float> distance_mm(points_mm.size());
  bone.model().sample(points_mm, distance_mm, {});
  const auto last = std::find_if(distance_mm.rbegin(), distance_mm.rend(), [](float d) { return d < 0.0F; });
  const Vec3 near =
      last == distance_mm.rend() ? target_mm : points_mm[static_cast<std::size_t>(distance_mm.rend() - last) - 1];
  return stick_to_surface(bone, near);
}

}  // namespace spinaltap

#include "vdb/segment_vertebra.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "core/base/error.h"
#include "core/segment/binned_ct.h"
#include "core/segment/bone_levels.h"
#include "core/segment/distance_transform.h"
#include "core/segment/find_body_seed.h"
#include "core/segment/grey_closing.h"
#include "core/segment/vertebra_markers.h"
#include "vdb/connected_parts.h"
#include "vdb/detail/refine_mask.h"

namespace spinaltap {
namespace {

using Mask = std::vector<std::uint8_t>;

/// Where the wanted vertebra is cut out: the CT around the seed, in steps of about 0.8 mm.
struct Work {
  VoxelBox box;  ///< of the CT
  std::array<int, 3> bins;
  FloatGrid hu;      ///< as scanned
  FloatGrid smooth;  ///< blurred as the noise asks for
};

std::string in_words(const Vec3& p_mm) {
  std::ostringstream text;
  text << '(' << p_mm.x() << ", " << p_mm.y() << ", " << p_mm.z() << ") mm";
  return text.str();
}

void check_seed(const CtVolume& ct, const Vec3& seed_mm) {
  if (!seed_mm.allFinite()) fail("seed: expected a position in mm, found one that is not a number");
  const GridGeometry& geometry = ct.geometry;
  const Vec3 p = geometry.to_index(seed_mm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (p[static_cast<Eigen::Index>(axis)] >= -0.5 && p[static_cast<Eigen::Index>(axis)] <= geometry.size[axis] - 0.5) {
      continue;
    }
    Box3 reach(geometry.origin_mm, geometry.origin_mm);
    const Vec3 last(geometry.size[0] - 1, geometry.size[1] - 1, geometry.size[2] - 1);
    for (int corner = 0; corner < 8; ++corner) {
      reach.extend(geometry.to_patient(last.cwiseProduct(Vec3(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1))));
    }
    fail("seed: expected a point in the CT, from ", in_words(reach.min()), " to ", in_words(reach.max()), ", found ",
         in_words(seed_mm));
  }
  constexpr double kAirHu = -300.0;
  const double hu = sample_hu(ct, seed_mm, 0.0);
  if (hu < kAirHu) {
    fail("seed: expected a point in a vertebral body, found air (", std::lround(hu), " HU) at ", in_words(seed_mm));
  }
}

Work work_around(const CtVolume& ct, const Vec3& seed_mm, const BoneLevels& levels) {
  constexpr double kStepMm = 0.8;
  // The seed lies anywhere in the body; transverse processes and ribs, the spinous process, the bodies above and below.
  const Box3 box_mm(seed_mm - Vec3(70.0, 55.0, 65.0), seed_mm + Vec3(70.0, 95.0, 65.0));
  Work work;
  work.box = voxels_of(box_mm, ct.geometry);
  work.bins = bins_for(ct.geometry, kStepMm);
  work.hu = bin_hu(ct, work.box, work.bins);
  work.smooth = blurred_as_asked(work.hu, levels, ct);
  return work;
}

Mask at_least(const FloatGrid& hu, double threshold_hu) {
  Mask mask(hu.values.size());
  std::transform(hu.values.begin(), hu.values.end(), mask.begin(),
                 [&](float value) { return static_cast<std::uint8_t>(static_cast<double>(value) >= threshold_hu); });
  return mask;
}

/// Bone by threshold with hysteresis, the inside of the body whatever its CT numbers, and what they enclose.
Mask find_bone(const FloatGrid& smooth, const BoneLevels& levels, const std::vector<float>& depth_mm) {
  Mask bone = parts_that_touch(at_least(smooth, levels.low_hu), at_least(smooth, levels.sure_hu), smooth.geometry);
  for (std::size_t v = 0; v < bone.size(); ++v) {
    if (depth_mm[v] > kSureDepthMm) bone[v] = 1;
  }
  return fill_hollows(bone, smooth.geometry, std::max(1.0, smooth.geometry.spacing_mm.maxCoeff()));
}

/// How well each voxel conducts: 1 within the body; elsewhere little in a dark gap between two bright walls.
std::vector<float> conductivity_of(const FloatGrid& hu, const std::vector<float>& closed,
                                   const std::vector<float>& depth_mm) {
  // The power makes a joint space, at most nine tenths as bright as the cortex beside it, a barrier, even where it is
  // wider than the pedicle, the only other way from the arch to a body.
  constexpr double kPower = 30.0;
  constexpr double kLeast = 1e-3;
  constexpr double kLeastHu = 50.0;
  std::vector<float> conductivity(hu.values.size());
  tbb::parallel_for(std::size_t{0}, conductivity.size(), [&](std::size_t v) {
    const double ratio =
        std::clamp(static_cast<double>(hu.values[v]) / std::max<double>(closed[v], kLeastHu), 0.0, 1.0);
    conductivity[v] = depth_mm[v] > 0.0F ? 1.0F : static_cast<float>(std::max(kLeast, std::pow(ratio, kPower)));
  });
  return conductivity;
}

/// Ribs: bone that goes on from where transverse processes may end to where they certainly have.
Mask find_ribs(const Mask& bone, const BodyCylinder& body, const GridGeometry& geometry) {
  constexpr double kFromMm = 38.0;    // thoracic transverse processes, which meet ribs, end before
  constexpr double kBeyondMm = 55.0;  // and so do the longest lumbar ones
  return parts_that_touch(voxels_to_the_side(bone, body, geometry, kFromMm),
                          voxels_to_the_side(bone, body, geometry, kBeyondMm), geometry);
}

/// Takes off the outermost voxels that the blur of dense bone, not bone itself, lifts over the threshold.
void trim_rim(Mask& mine, const Mask& bone, const FloatGrid& smooth, const std::vector<float>& peak,
              const std::vector<float>& depth_mm) {
  Mask soft(bone.size());
  std::transform(bone.begin(), bone.end(), soft.begin(), [](std::uint8_t b) { return std::uint8_t{b == 0}; });
  const std::vector<float> to_soft = squared_distance_to(soft, smooth.geometry);
  const double reach_mm = 1.01 * smooth.geometry.spacing_mm.maxCoeff();
  for (std::size_t v = 0; v < mine.size(); ++v) {
    const bool on_rim = static_cast<double>(to_soft[v]) <= reach_mm * reach_mm;
    if (on_rim && !(depth_mm[v] > kSureDepthMm) && smooth.values[v] < detail::least_share_of_peak(peak[v])) mine[v] = 0;
  }
}

/// Area of the faces between the vertebra and other bone, mm².
double cut_area_mm2(const Mask& mine, const std::vector<WalkerVoxel>& markers, const GridGeometry& geometry) {
  const auto is_bone = [&](std::size_t voxel) { return markers[voxel] != WalkerVoxel::kOutside; };
  const std::array<std::size_t, 3> stride{1, geometry.offset(0, 1, 0), geometry.offset(0, 0, 1)};
  double area_mm2 = 0.0;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const std::array<int, 3> index{i, j, k};
        const std::size_t here = geometry.offset(i, j, k);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          if (index[axis] + 1 >= geometry.size[axis]) continue;
          const std::size_t next = here + stride[axis];
          const bool cut = (mine[here] != 0 && mine[next] == 0 && is_bone(next)) ||
                           (mine[next] != 0 && mine[here] == 0 && is_bone(here));
          if (cut) area_mm2 += geometry.spacing_mm.prod() / geometry.spacing_mm[static_cast<Eigen::Index>(axis)];
        }
      }
    }
  }
  return area_mm2;
}

bool reaches_border(const BoneMask& mask) {
  const VoxelBox box = mask_box(mask);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (box.low[axis] == 0 || box.high[axis] == mask.geometry.size[axis] - 1) return true;
  }
  return false;
}

/// Refuses a seed that lies away from the bone that was found in its name.
void check_near(const Mask& mine, const GridGeometry& geometry, const Vec3& seed_mm) {
  constexpr double kMostMm = 3.0;  // over a hole in the wall, or in marrow that the noise left open
  double least_mm = std::numeric_limits<double>::infinity();
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        if (mine[geometry.offset(i, j, k)] == 0) continue;
        least_mm = std::min(least_mm, (geometry.to_patient(Vec3(i, j, k)) - seed_mm).norm());
      }
    }
  }
  if (least_mm <= kMostMm) return;
  fail("seed: expected a point in a vertebral body, found the nearest one ", std::lround(least_mm), " mm from ",
       in_words(seed_mm));
}

}  // namespace

Segmentation segment_vertebra(const CtVolume& ct, const SegmentOptions& options, const Progress& progress) {
  progress.report("finding the vertebral body", 0.0);
  const BoneLevels levels = choose_bone_levels(ct, options.threshold_hu);
  if (options.seed_mm) check_seed(ct, *options.seed_mm);
  const Vec3 seed_mm = options.seed_mm ? *options.seed_mm : find_body_seed(ct, levels);
  const VertebralBody body = find_vertebral_body(smooth_around(ct, seed_mm), seed_mm, {levels.low_hu});
  constexpr double kOutsideMm = 2.0;  // the surface's own error, and a seed on the wall
  if (!body.cylinder.is_body() || body.surface.depth_mm(seed_mm) < -kOutsideMm) {
    fail("seed: expected a point in a vertebral body, found no body's wall around ", in_words(seed_mm),
         "; the best place has ", std::lround(100.0 * body.cylinder.fit), " % of one");
  }
  progress.report("finding bone", 0.0);
  const Work work = work_around(ct, seed_mm, levels);
  const GridGeometry& geometry = work.hu.geometry;
  const std::vector<float> depth_mm = depth_in_body_mm(body, geometry);
  const Mask bone = find_bone(work.smooth, levels, depth_mm);
  progress.report("finding bone", 0.5);
  constexpr double kGapReachMm = 1.6;  // joint spaces are up to 3 mm wide
  const GreyClosing closing = close_gaps(work.hu, kGapReachMm);
  const Mask ribs = find_ribs(bone, body.cylinder, geometry);
  const std::vector<WalkerVoxel> markers = place_markers(
      bone, ribs, depth_mm, work.smooth, 0.5 * (levels.low_hu + levels.sure_hu), body.cylinder, ct.geometry);
  const std::vector<float> probability =
      walk_randomly(markers, conductivity_of(work.hu, closing.closed, depth_mm), geometry, progress);

  Mask mine(bone.size());
  Mask core(bone.size());
  for (std::size_t v = 0; v < mine.size(); ++v) {
    mine[v] = probability[v] > 0.5F ? 1 : 0;
    core[v] = markers[v] == WalkerVoxel::kWanted ? 1 : 0;
  }
  const double cut_mm2 = cut_area_mm2(mine, markers, geometry);
  trim_rim(mine, bone, work.smooth, closing.peak, depth_mm);
  constexpr double kPitMm = 1.5;
  mine = fill_hollows(mine, geometry, kPitMm);
  const std::size_t parts = part_sizes(mine, geometry).size();
  mine = parts_that_touch(mine, core, geometry);

  check_near(mine, geometry, seed_mm);

  Segmentation result;
  result.mask =
      detail::refine_mask({mine, bone, depth_mm, closing.peak, work.hu.geometry, work.box, work.bins}, ct, levels);
  if (mask_box(result.mask).empty()) fail("found no bone around ", in_words(seed_mm));
  result.report = {.seed_mm = seed_mm,
                   .threshold_hu = levels.low_hu,
                   .sure_threshold_hu = levels.sure_hu,
                   .noise_hu = levels.noise_hu,
                   .body_centre_mm = body.cylinder.centre_mm,
                   .body_size_mm = 2.0 * body.cylinder.half_mm,
                   .body_fit = body.cylinder.fit,
                   .cut_area_mm2 = cut_mm2,
                   .parts_dropped = parts > 0 ? parts - 1 : 0,
                   .reaches_border = reaches_border(result.mask)};
  progress.report("finding bone", 1.0);
  return result;
}

}  // namespace spinaltap

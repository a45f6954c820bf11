#include "core/segment/level_cut.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/free_memory.h"
#include "core/segment/detail/binned_ct.h"
#include "core/segment/detail/connected_parts.h"
#include "core/segment/detail/grey_closing.h"
#include "core/segment/detail/refine_mask.h"
#include "core/segment/distance_transform.h"

namespace spinaltap {
namespace {

using Mask = std::vector<std::uint8_t>;

constexpr double kCutStepMm = 0.8;

/// Ribs, transverse and spinous processes and the bodies above and below, in the body's own frame.
VoxelBox box_around(const BodyCylinder& body, const GridGeometry& ct, const std::array<int, 3>& bins) {
  const Mat3 axes = body.axes();
  Box3 box_mm;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 own((corner & 1) != 0 ? 62.0 : -62.0,
                   (corner & 2) != 0 ? body.half_mm.y() + 75.0 : -body.half_mm.y() - 16.0,
                   (corner & 4) != 0 ? body.half_mm.z() + 24.0 : -body.half_mm.z() - 52.0);
    box_mm.extend(body.centre_mm + axes * own);
  }
  // Tilted bodies have a large box; nothing of the vertebra lies in its far corners.
  const Box3 reach(body.centre_mm - Vec3(75.0, 60.0, 75.0), body.centre_mm + Vec3(75.0, 100.0, 55.0));
  VoxelBox box = voxels_of(box_mm.intersection(reach), ct);
  for (std::size_t axis = 0; axis < 3; ++axis) box.low[axis] -= box.low[axis] % bins[axis];
  return box;
}

Mask at_least(const FloatGrid& hu, double threshold_hu) {
  Mask mask(hu.values.size());
  std::transform(hu.values.begin(), hu.values.end(), mask.begin(),
                 [&](float value) { return static_cast<std::uint8_t>(static_cast<double>(value) >= threshold_hu); });
  return mask;
}

/// Bone by threshold with hysteresis, the insides of bodies whatever their CT numbers, and what they enclose.
Mask find_bone(const FloatGrid& smooth, const BoneLevels& levels, const std::vector<float>& depth_mm,
               const std::vector<float>& depth_in_others_mm) {
  Mask bone = parts_that_touch(at_least(smooth, levels.low_hu), at_least(smooth, levels.sure_hu), smooth.geometry);
  for (std::size_t v = 0; v < bone.size(); ++v) {
    if (depth_mm[v] > kSureDepthMm || depth_in_others_mm[v] > kSureDepthMm) bone[v] = 1;
  }
  return fill_hollows(bone, smooth.geometry, std::max(1.0, smooth.geometry.spacing_mm.maxCoeff()));
}

/// How well each voxel conducts: 1 within the body; elsewhere little in a dark gap between two bright walls.
std::vector<float> conductivity_of(const FloatGrid& hu, const std::vector<float>& closed,
                                   const std::vector<float>& depth_mm) {
  // The power makes a joint space, at most nine tenths as bright as the cortex beside it, a barrier, even where it is
  // wider than the pedicle, the only other way from the arch to a body.
  constexpr double kPower = 30.0;
  constexpr double kMin = 1e-3;
  constexpr double kMinHu = 50.0;
  std::vector<float> conductivity(hu.values.size());
  tbb::parallel_for(std::size_t{0}, conductivity.size(), [&](std::size_t v) {
    const double ratio = std::clamp(static_cast<double>(hu.values[v]) / std::max<double>(closed[v], kMinHu), 0.0, 1.0);
    conductivity[v] = depth_mm[v] > 0.0F ? 1.0F : static_cast<float>(std::max(kMin, std::pow(ratio, kPower)));
  });
  return conductivity;
}

/// Ribs: bone that goes on from where transverse processes may end to where they certainly have, or to the CT's border;
/// and what of the same bones lies beside the body. Beside a lumbar body that is a hip bone, which has no head there,
/// and beside one of the neck a first rib or a collarbone.
Mask find_ribs(const Mask& bone, const std::vector<float>& depth_mm, const std::vector<float>& depth_in_others_mm,
               const BodyInRow& row, const GridGeometry& geometry, const GridGeometry& ct) {
  const BodyCylinder& body = row.body().cylinder;
  constexpr double kThoracicMm = 38.0;  // transverse processes that meet ribs end before
  constexpr double kLumbarMm = 48.0;    // those of L3 and L5 reach as far
  constexpr double kBeyondMm = 55.0;    // and the longest end before
  const Mask side = voxels_to_the_side(bone, body, geometry, row.is_lumbar() ? kLumbarMm : kThoracicMm);
  Mask goes_on = voxels_to_the_side(bone, body, geometry, kBeyondMm);
  const Mask border = voxels_on_border(geometry, ct);
  for (std::size_t v = 0; v < border.size(); ++v) {
    if (border[v] != 0 && side[v] != 0) goes_on[v] = 1;
  }
  Mask ribs = parts_that_touch(side, goes_on, geometry);
  if (row.is_lumbar() || row.is_cervical()) return ribs;
  constexpr double kBesideMm = 4.0;
  const Mask beside = voxels_to_the_side(bone, body, geometry, body.half_mm.x() + kBesideMm);
  const Mask reached = parts_that_touch(beside, ribs, geometry);
  const Mask heads = voxels_of_rib_heads(reached, body, geometry);
  for (std::size_t v = 0; v < heads.size(); ++v) {
    const double depth = static_cast<double>(std::max(depth_mm[v], depth_in_others_mm[v]));
    if (heads[v] != 0 && depth < -kBesideMm) ribs[v] = 1;
  }
  return ribs;
}

/// Depth in the nearest of the other bodies.
std::vector<float> depth_in_others(const BodyInRow& row, const GridGeometry& geometry) {
  std::vector<float> depth_mm;
  for (std::size_t n = 0; n < row.bodies.size(); ++n) {
    constexpr double kReachMm = 130.0;  // further than the box
    if (n == row.own) continue;
    if ((row.bodies[n].cylinder.centre_mm - row.body().cylinder.centre_mm).norm() > kReachMm) continue;
    const std::vector<float> here = depth_in_body_mm(row.bodies[n], geometry);
    if (depth_mm.empty()) depth_mm = here;
    std::transform(depth_mm.begin(), depth_mm.end(), here.begin(), depth_mm.begin(),
                   [](float a, float b) { return std::max(a, b); });
  }
  constexpr float kNowhere = -1000.0F;
  if (depth_mm.empty()) depth_mm.assign(geometry.voxel_count(), kNowhere);
  return depth_mm;
}

/// What a user said, in the blocks of the cut; it holds for bone only.
void apply(const std::vector<MarkedVoxels>& marks, std::size_t own, const GridGeometry& ct, LevelCut& cut) {
  const auto columns = static_cast<std::size_t>(ct.size[0]);
  const auto rows = static_cast<std::size_t>(ct.size[1]);
  for (const MarkedVoxels& marked : marks) {
    for (const std::size_t offset : marked.offsets) {
      const std::array<int, 3> voxel{static_cast<int>(offset % columns), static_cast<int>(offset / columns % rows),
                                     static_cast<int>(offset / columns / rows)};
      std::array<int, 3> block{};
      bool is_within = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        is_within = is_within && voxel[axis] >= cut.box.low[axis] && voxel[axis] <= cut.box.high[axis];
        block[axis] = (voxel[axis] - cut.box.low[axis]) / cut.bins[axis];
      }
      if (!is_within) continue;
      const std::size_t at = cut.geometry.offset(block[0], block[1], block[2]);
      if (cut.bone[at] == 0) continue;
      cut.markers[at] = marked.body == own ? WalkerVoxel::kWanted : WalkerVoxel::kOther;
      if (marked.body != own) cut.given_away.push_back(at);
    }
  }
}

/// Takes off the outermost voxels that the blur of dense bone, not bone itself, lifts over the threshold.
void trim_rim(Mask& mine, const LevelCut& cut) {
  Mask soft(cut.bone.size());
  std::transform(cut.bone.begin(), cut.bone.end(), soft.begin(), [](std::uint8_t b) { return std::uint8_t{b == 0}; });
  const double reach_mm = 1.01 * cut.geometry.spacing_mm.maxCoeff();
  const std::vector<float> to_soft = squared_distance_within(soft, cut.geometry, reach_mm);
  for (std::size_t v = 0; v < mine.size(); ++v) {
    const bool on_rim = static_cast<double>(to_soft[v]) <= reach_mm * reach_mm;
    if (on_rim && !(cut.depth_mm[v] > kSureDepthMm) && cut.brightness[v] == Brightness::kDim) {
      mine[v] = 0;
    }
  }
}

Brightness brightness_of(float hu, float edge_hu) {
  constexpr float kMetalHu = 2500.0F, kCementHu = 900.0F;
  if (hu < edge_hu) return Brightness::kDim;
  return hu < kCementHu ? Brightness::kBone : hu < kMetalHu ? Brightness::kCement : Brightness::kMetal;
}

}  // namespace

void LevelCut::keep_probability_only() {
  free_memory(brightness, peak_hu, depth_mm, conductivity, bone, ribs, markers, given_away);
}

LevelCut cut_level(const CtVolume& ct, const BoneLevels& levels, const BodyInRow& row,
                   const std::vector<MarkedVoxels>& marks) {
  LevelCut cut;
  cut.bins = bins_for(ct.geometry, kCutStepMm);
  cut.box = box_around(row.body().cylinder, ct.geometry, cut.bins);
  FloatGrid hu = bin_hu(ct, cut.box, cut.bins);
  FloatGrid smooth = blurred_as_asked(hu, levels, ct);
  cut.geometry = smooth.geometry;
  const GridGeometry& geometry = cut.geometry;
  cut.depth_mm = depth_in_body_mm(row.body(), geometry);
  {
    const std::vector<float> others_mm = depth_in_others(row, geometry);
    cut.bone = find_bone(smooth, levels, cut.depth_mm, others_mm);
    cut.ribs = find_ribs(cut.bone, cut.depth_mm, others_mm, row, geometry, ct.geometry);
    cut.markers = place_markers({.bone = cut.bone,
                                 .ribs = cut.ribs,
                                 .depth_mm = cut.depth_mm,
                                 .depth_in_others_mm = others_mm,
                                 .hu = smooth,
                                 .dense_hu = 0.5 * (levels.low_hu + levels.sure_hu),
                                 .ct_geometry = ct.geometry},
                                row);
  }
  apply(marks, row.own, ct.geometry, cut);
  constexpr double kGapReachMm = 1.6;  // joint spaces are up to 3 mm wide
  {
    GreyClosing closing = close_gaps(hu, kGapReachMm);
    cut.conductivity = conductivity_of(hu, closing.closed, cut.depth_mm);
    free_memory(hu.values, closing.closed);
    // Of the blurred CT: the brightest of many noisy voxels says more about noise than about bone.
    cut.peak_hu = levels.blur_voxels > 0.0 ? close_gaps(smooth, kGapReachMm).peak : std::move(closing.peak);
  }
  const BoneEdge edge(ct.geometry);
  cut.brightness.resize(cut.peak_hu.size());
  std::transform(smooth.values.begin(), smooth.values.end(), cut.peak_hu.begin(), cut.brightness.begin(),
                 [&](float value, float peak) { return brightness_of(value, edge.hu(peak)); });
  free_memory(smooth.values);
  cut.probability = walk_randomly(cut.markers, cut.conductivity, geometry);
  return cut;
}

SideBone find_side_bone(const LevelCut& cut, const Mask& mine, const BodyCylinder& body, double side) {
  constexpr double kBesideMm = 4.0;  // from the body's side: here begin heads of ribs and transverse processes
  constexpr double kMinReachMm = 14.0;
  constexpr double kEndMm = 5.0;
  const GridGeometry& geometry = cut.geometry;
  const auto for_mine = [&](const auto& visit) {
    for_voxels_by_body(mine, geometry, body,
                       [&](std::size_t voxel, const Vec3& p) { visit(voxel, side * p.x() - body.half_mm.x()); });
  };
  double reach_mm = 0.0;
  for_mine([&](std::size_t, double beside_mm) { reach_mm = std::max(reach_mm, beside_mm); });
  SideBone found;
  if (reach_mm < kMinReachMm) return found;
  std::vector<WalkerVoxel> voxels(mine.size(), WalkerVoxel::kOutside);
  for_mine([&](std::size_t voxel, double beside_mm) {
    if (beside_mm < -kBesideMm) return;
    const bool is_own = cut.markers[voxel] == WalkerVoxel::kWanted || beside_mm < -0.5 * kBesideMm;
    voxels[voxel] = is_own                          ? WalkerVoxel::kOther
                    : beside_mm > reach_mm - kEndMm ? WalkerVoxel::kWanted
                                                    : WalkerVoxel::kFree;
  });
  const std::vector<float> chance = walk_randomly(voxels, cut.conductivity, geometry);
  constexpr float kLow = 0.25F;
  constexpr float kHigh = 0.75F;
  double turning = 0.0;
  double beyond = 0.0;
  for (std::size_t v = 0; v < chance.size(); ++v) {
    if (chance[v] > 0.5F) found.voxels.push_back(v);
    if (chance[v] > kLow && chance[v] < kHigh) turning += 1.0;
    if (chance[v] >= kHigh) beyond += 1.0;
  }
  // Transverse processes have 0.4 to 0.6, in much noise down to 0.18; ribs 0.03 to 0.1.
  constexpr double kJoint = 0.14;
  constexpr double kMinMm3 = 250.0;  // less is no rib
  if (beyond * geometry.spacing_mm.prod() > kMinMm3) found.sharpness = turning / (turning + beyond);
  if (found.sharpness > kJoint) found.voxels.clear();
  return found;
}

double cut_area_mm2(const LevelCut& cut, const Mask& mine) {
  const GridGeometry& geometry = cut.geometry;
  const auto is_bone = [&](std::size_t voxel) { return cut.markers[voxel] != WalkerVoxel::kOutside; };
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
          const bool is_cut = (mine[here] != 0 && mine[next] == 0 && is_bone(next)) ||
                              (mine[next] != 0 && mine[here] == 0 && is_bone(here));
          if (is_cut) area_mm2 += geometry.spacing_mm.prod() / geometry.spacing_mm[static_cast<Eigen::Index>(axis)];
        }
      }
    }
  }
  return area_mm2;
}

FinishedLevel finish_level(const LevelCut& cut, Mask mine, const Mask& others, const CtVolume& ct,
                           const BoneLevels& levels) {
  Mask core(cut.markers.size());
  std::transform(cut.markers.begin(), cut.markers.end(), core.begin(),
                 [](WalkerVoxel marker) { return std::uint8_t{marker == WalkerVoxel::kWanted}; });
  trim_rim(mine, cut);
  constexpr double kPitMm = 1.5;
  mine = fill_hollows(mine, cut.geometry, kPitMm);
  for (std::size_t v = 0; v < mine.size(); ++v) {
    if (others[v] != 0) mine[v] = 0;
  }
  for (const std::size_t voxel : cut.given_away) mine[voxel] = 0;
  FinishedLevel finished;
  const std::size_t parts = part_sizes(mine, cut.geometry).size();
  finished.parts_dropped = parts > 0 ? parts - 1 : 0;
  mine = parts_that_touch(mine, core, cut.geometry);
  RefinedMask refined =
      refine_mask({mine, cut.bone, cut.depth_mm, cut.peak_hu, cut.geometry, cut.box, cut.bins}, ct, levels);
  finished.blocks = std::move(mine);
  finished.inside = std::move(refined.inside);
  finished.box = refined.box;
  return finished;
}

}  // namespace spinaltap

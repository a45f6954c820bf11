#include "core/anatomy/detail/pedicle_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/anatomy/detail/cubic_polynomial.h"
#include "core/anatomy/pedicle_section.h"

namespace spinaltap {
namespace {

/// A plane that cuts a pedicle, and a place in the pedicle near it.
struct Cut {
  Vec3 centre_mm = Vec3::Zero();
  Vec3 axis = -Vec3::UnitY();  ///< unit normal, forward
};

/// The cut moved along its axis by x mm and turned by y about the way up and z about the way across, rad.
Cut moved(const Cut& cut, const Vec3& upward, const Vec3& by) {
  const Vec3 across = upward.cross(cut.axis).normalized(), up = cut.axis.cross(across);
  return {cut.centre_mm + by.x() * cut.axis,
          (cut.axis + std::tan(by.y()) * across + std::tan(by.z()) * up).normalized()};
}

/// Sections that run into body or arch in many directions are none of a pedicle.
bool is_closed(const BoneSection& section) { return section.inside && section.endless == 0; }

/// The place deepest in bone beside the canal at one distance behind its middle.
std::optional<Vec3> deepest_beside_canal(const BoneShape& bone, const PedicleRegion& region, double side,
                                         double back_mm) {
  constexpr double kReachMm = 15.0, kStepMm = 1.0, kMinDepthMm = 0.8;
  double depth_mm = kMinDepthMm;
  std::optional<Vec3> deepest;
  for (double x = 0.8 * region.canal_radius_mm; x <= region.canal_radius_mm + kReachMm; x += kStepMm) {
    for (double z = region.lowest_mm; z <= region.highest_mm; z += kStepMm) {
      const Vec3 p_mm = region.canal_mm + region.axes * Vec3(side * x, back_mm, z);
      if (!(-bone.lattice_mm(p_mm) > depth_mm)) continue;
      depth_mm = -bone.lattice_mm(p_mm);
      deepest = p_mm;
    }
  }
  return deepest;
}

/// The coronal section of least area between the body and the arch.
std::optional<Cut> coronal_start(const BoneShape& bone, const PedicleRegion& region, double side) {
  constexpr double kStepMm = 0.5, kAheadMm = 6.0, kMinAreaMm2 = 8.0;
  const Vec3 forward = -region.axes.col(1);
  std::optional<Cut> best;
  double min_mm2 = std::numeric_limits<double>::infinity();
  for (double back = -region.canal_radius_mm - kAheadMm; back <= 0.5 * region.canal_radius_mm; back += kStepMm) {
    const std::optional<Vec3> start_mm = deepest_beside_canal(bone, region, side, back);
    // A gap: what lies further ahead is not joined to the arch.
    if (!start_mm) {
      if (back > -region.canal_radius_mm) return std::nullopt;
      continue;
    }
    const BoneSection section = section_around(bone, *start_mm, forward, region.axes.col(2));
    if (!is_closed(section) || section.area_mm2 < kMinAreaMm2 || section.area_mm2 > min_mm2) continue;
    min_mm2 = section.area_mm2;
    best = Cut{section.centre_mm, forward};
  }
  return best;
}

struct TriedCut {
  Vec3 move;
  BoneSection section;
};

/// Sections at all moves of a box of steps around a cut.
std::vector<TriedCut> tried_around(const BoneShape& bone, const Cut& cut, const Vec3& upward, const Vec3& reach,
                                   const Eigen::Vector3i& steps) {
  std::vector<TriedCut> tried;
  for (int a = -steps[0]; a <= steps[0]; ++a) {
    for (int b = -steps[1]; b <= steps[1]; ++b) {
      for (int c = -steps[2]; c <= steps[2]; ++c) {
        tried.push_back({reach.cwiseProduct(Vec3(a, b, c)).cwiseQuotient(steps.cast<double>()), {}});
      }
    }
  }
  tbb::parallel_for(std::size_t{0}, tried.size(), [&](std::size_t n) {
    const Cut here = moved(cut, upward, tried[n].move);
    tried[n].section = section_around(bone, here.centre_mm, here.axis, upward);
  });
  return tried;
}

const TriedCut* smallest_of(const std::vector<TriedCut>& tried) {
  const TriedCut* smallest = nullptr;
  for (const TriedCut& one : tried) {
    if (!is_closed(one.section)) continue;
    if (smallest == nullptr || one.section.area_mm2 < smallest->section.area_mm2) smallest = &one;
  }
  return smallest;
}

/// Where a cubic form through the areas is least; nothing where it has no minimum.
std::optional<Vec3> minimum_of_areas(const std::vector<TriedCut>& tried, const Vec3& reach, double min_mm2) {
  constexpr double kMaxGrowth = 0.3;  // beyond, the section is no more one of the isthmus
  CubicPolynomial form;
  for (const TriedCut& one : tried) {
    if (!is_closed(one.section)) continue;
    const double growth = one.section.area_mm2 / min_mm2 - 1.0;
    if (growth < kMaxGrowth) form.add(one.move.cwiseQuotient(reach), growth, 1.0 - growth / kMaxGrowth);
  }
  const std::optional<Vec3> minimum = form.minimum();
  if (!minimum) return std::nullopt;
  return Vec3(minimum->cwiseProduct(reach));
}

}  // namespace

std::optional<PedicleLandmarks> find_pedicle(const BoneShape& bone, const PedicleRegion& region, double side) {
  const Vec3 upward = region.axes.col(2);
  std::optional<Cut> cut = coronal_start(bone, region, side);
  if (!cut) return std::nullopt;
  const std::vector<TriedCut> coarse =
      tried_around(bone, *cut, upward, Vec3(4.0, 35.0 * kDegree, 28.0 * kDegree), Eigen::Vector3i(3, 5, 4));
  if (const TriedCut* best = smallest_of(coarse)) {
    cut = Cut{best->section.centre_mm, moved(*cut, upward, best->move).axis};
  }
  constexpr int kRounds = 4;
  const Vec3 reach(2.5, 14.0 * kDegree, 14.0 * kDegree);
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<TriedCut> tried = tried_around(bone, *cut, upward, reach, Eigen::Vector3i(4, 4, 4));
    const TriedCut* best = smallest_of(tried);
    if (best == nullptr) return std::nullopt;
    const Vec3 move = minimum_of_areas(tried, reach, best->section.area_mm2).value_or(best->move);
    const Cut next = moved(*cut, upward, move);
    const BoneSection section = section_around(bone, next.centre_mm, next.axis, upward);
    if (!is_closed(section)) return std::nullopt;
    cut = Cut{section.centre_mm, next.axis};
    if (std::abs(move.x()) < 0.02 && move.tail<2>().norm() < 0.1 * kDegree) break;
  }
  const BoneSection section = sharpened(bone, section_around(bone, cut->centre_mm, cut->axis, upward));
  if (!is_closed(section)) return std::nullopt;
  SectionSize size = size_of(section);
  // A pedicle may be wider than high, as many of L5 are.
  if (std::abs(size.small_axis.dot(region.axes.col(0))) < std::abs(size.large_axis.dot(region.axes.col(0)))) {
    std::swap(size.small_axis, size.large_axis);
    std::swap(size.small_mm, size.large_mm);
  }
  PedicleLandmarks pedicle;
  pedicle.isthmus_mm = section.centre_mm;
  pedicle.axis = cut->axis;
  pedicle.width_axis = size.small_axis;
  pedicle.height_axis = size.large_axis;
  pedicle.width_mm = size.small_mm;
  pedicle.height_mm = size.large_mm;
  if (pedicle.width_axis.dot(region.axes.col(0)) < 0.0) pedicle.width_axis = -pedicle.width_axis;
  if (pedicle.height_axis.dot(upward) < 0.0) pedicle.height_axis = -pedicle.height_axis;
  return pedicle;
}

}  // namespace spinaltap

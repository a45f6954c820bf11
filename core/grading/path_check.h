#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/anatomy/landmarks.h"
#include "core/base/geometry.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// Signed distances to a bone's surface at places (patient LPS, mm), negative inside, clamped at a band's width.
using DistanceSampler = std::function<void(std::span<const Vec3> points_mm, std::span<float> distance_mm)>;

/// A bone as a path is checked against it.
struct PathCheckBone {
  DistanceSampler distance;
  double band_mm = 0.0;  ///< the samplers' width
  Box3 bounds_mm;        ///< around its surface
  /// Asked only where it decides; null, or gives null: no vertebra.
  std::function<const Landmarks*()> landmarks = {};
};

struct PathCheckOptions {
  /// How far the entry may lie off the surface, to either side, mm. A plate's may by half its width more, a burr's by
  /// its radius: they cut beside their axes.
  double tolerance_mm = 2.0;
  bool from_the_front = false;  ///< the path is meant to come from the front
};
/// Of a milling, whose path is only the line that depths are told along.
inline constexpr double kMillingToleranceMm = 10.0;

/// What does not fit between a path and a bone.
struct PathCheck {
  /// A sentence each, without a full stop; empty: the path fits.
  std::vector<std::string> faults;
  /// How its points may have been meant, since so they fit: "the points are RAS: x and y negated"; empty: not known.
  std::string likely_cause;

  bool fits() const { return faults.empty(); }
  /// All of it on one line, with the path's name.
  std::string words(const DrillPath& path) const;
};

/// Checks that a path meets the bone, begins on its surface, leads into it, and, where the bone is a vertebra, does not
/// come from the front: places that were typed in another frame or unit, in another order, from the target to the
/// entry, or for another bone. Where it does not fit, other readings of its points are tried, the common ones first;
/// those that fit are named, unless over two are as common.
PathCheck check_path_on_bone(const DrillPath& path, const PathCheckBone& bone, const PathCheckOptions& options = {});

}  // namespace spinaltap

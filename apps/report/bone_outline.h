#pragma once

#include <functional>
#include <span>
#include <vector>

#include "apps/report/bit_outline.h"
#include "apps/report/slice_frame.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// What slices need of a bone to draw its outline. Safe to call from many threads.
struct OutlinedBone {
  /// Signed distances (mm, negative inside, at least right where they are below 0.4 mm) at places, patient LPS, mm.
  std::function<void(std::span<const Vec3>, std::span<float>)> distance;
  /// Whether a place of the surface lies on the canal's wall; none: nowhere.
  std::function<bool(const Vec3&)> is_canal_wall = {};
};

/// Of a baked bone; with the canal's wall where it has landmarks. Keeps the bone.
OutlinedBone outlined(const Bone& bone);

/// A stretch of a bone's outline in a picture.
struct OutlineRun {
  PixelPolygon points;     ///< column, row
  bool is_closed = false;  ///< the last goes on to the first
  bool is_canal = false;   ///< on the canal's wall
};

/// Where the picture's plane cuts the bone's surface: the zero set of its distance by marching squares of 0.25 mm,
/// thinned to places no further than 0.02 mm from it. Runs end at the picture's border and where the canal's wall
/// begins.
std::vector<OutlineRun> bone_outline(const OutlinedBone& bone, const SliceFrame& frame);

}  // namespace spinaltap

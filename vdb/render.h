#pragma once

#include <optional>
#include <vector>

#include "core/base/image.h"
#include "core/base/progress.h"
#include "core/drill/drill_path.h"
#include "vdb/bone_model.h"

namespace spinaltap {

/// A bit in a picture.
struct RenderedBit {
  DrillBit bit;
  Pose pose;  ///< patient LPS, mm
};

struct RenderOptions {
  int width = 900;
  int height = 700;
  /// From where the eye looks, patient LPS: (0, 1, 0) looks at the back of the patient, from behind.
  Vec3 from = Vec3(0.0, 1.0, 0.0);
  Vec3 up = Vec3(0.0, 0.0, 1.0);
  /// The bone before it was cut or drilled: it fills the picture, and where a surface lies inside it, so is new, that
  /// surface is coloured by its CT number.
  const BoneModel* uncut = nullptr;
  /// How much of the light the bone's own surface keeps back, 0 to 1. Surfaces that are new are seen through it, and so
  /// are bit and paths.
  double opacity = 1.0;
  std::optional<RenderedBit> bit = {};
  std::vector<DrillPath> paths = {};  ///< drawn as thin rods from entry to target
};

/// A shaded picture of the bone by parallel projection, traced against the distance grid (no display server needed).
/// The bone fills the picture; a bit may reach beyond it. Bit-identical at any thread count. Throws Error on sizes that
/// are not 1 to 16384 pixels, an `up` along the view, an opacity beyond 0 to 1, and a bad bit or path.
Image render_bone(const BoneModel& bone, const RenderOptions& options, const Progress& progress = {});

}  // namespace spinaltap

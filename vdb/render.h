#pragma once

#include "core/base/image.h"
#include "core/base/progress.h"
#include "vdb/bone_model.h"

namespace spinaltap {

struct RenderOptions {
  int width = 900;
  int height = 700;
  /// From where the eye looks, patient LPS: (0, 1, 0) looks at the back of the patient, from behind.
  Vec3 from = Vec3(0.0, 1.0, 0.0);
  Vec3 up = Vec3(0.0, 0.0, 1.0);
  /// The bone before it was cut or drilled: it fills the picture, and where a surface lies inside it, so is new, that
  /// surface is coloured by its CT number.
  const BoneModel* uncut = nullptr;
};

/// A shaded picture of the bone by parallel projection, traced against the distance grid (no display server needed).
/// Bit-identical at any thread count.
Image render_bone(const BoneModel& bone, const RenderOptions& options, const Progress& progress = {});

}  // namespace spinaltap

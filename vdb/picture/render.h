#pragma once

#include <optional>
#include <vector>

#include "core/base/image.h"
#include "core/base/progress.h"
#include "core/tool/drill_path.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// A bit in a picture.
struct RenderedBit {
  DrillBit bit;
  Pose pose;  ///< patient LPS, mm
};

/// Cuts a bone open: what lies on the side that the normal points to is left out.
struct CutPlane {
  Vec3 point_mm;  ///< patient LPS
  Vec3 normal;    ///< not zero
};

/// Part of the bone, seen from near.
struct CloseUp {
  Vec3 centre_mm;         ///< in the middle of the picture, patient LPS
  double width_mm = 0.0;  ///< of the picture
};

struct RenderOptions {
  int width = 900;
  int height = 700;
  /// From where the eye looks, patient LPS: (0, 1, 0) looks at the back of the patient, from behind.
  Vec3 from = Vec3(0.0, 1.0, 0.0);
  Vec3 up = Vec3(0.0, 0.0, 1.0);
  std::optional<CutPlane> cut = {};
  /// How much of the light the bone's own surface keeps back, 0 to 1. Holes and cuts are seen through it, and so are
  /// bit and paths.
  double opacity = 1.0;
  std::optional<CloseUp> close_up = {};  ///< otherwise the whole bone is seen
  std::optional<RenderedBit> bit = {};
  std::vector<RenderedBit> tools = {};  ///< further ones, such as screws: in blue
  std::vector<DrillPath> paths = {};    ///< drawn as thin rods from entry to target
};

/// A shaded picture of the bone by parallel projection, traced against the distance grids (no display server needed).
/// The bone as it was before it was drilled fills the picture; a bit may reach beyond it. Holes and cuts have sharp
/// rims, and walls coloured by CT number, cancellous bone red to cortex white. Bit-identical at any thread count.
/// Throws Error on sizes that are not 1 to 16384 pixels, an `up` along the view, an opacity beyond 0 to 1, a cut or
/// close-up of nothing, and a bad bit or path.
Image render_bone(const BoneModel& bone, const RenderOptions& options, const Progress& progress = {});

/// The same picture of a drilled bone, sooner, where there is one of the bone before (by the same options): only rays
/// that pass near a hole are traced. Throws Error where the picture is of another size, too.
Image render_drilled(const BoneModel& drilled, const Image& before, const RenderOptions& options,
                     const Progress& progress = {});

}  // namespace spinaltap

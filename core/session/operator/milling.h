#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/scalar_field.h"
#include "core/session/operator/operator.h"
#include "core/session/operator/path_motion.h"
#include "core/tool/drill_bit.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// What a burr is to mill away, and how: a patch of a bone's surface, line by line and layer by layer. Patient LPS, mm.
struct Milling {
  enum class Way {
    raster,   ///< to and fro over the patch, along its longest extent
    contour,  ///< along its outline
  };
  enum class Depth {
    below_surface,  ///< follows the bone's surface as it was: decortication, a trough
    floor,          ///< down to a plane at right angles to `into`, whatever stands on it: laminectomy
  };

  std::string name;
  /// Corners, in order, on or near the surface. The tool's axis stays within them, so that it takes a radius more.
  std::vector<Vec3> outline_mm;
  Vec3 into = Vec3::Zero();  ///< unit, into the bone: the tool's axis all the way
  Way way = Way::raster;
  Depth depth = Depth::below_surface;
  /// Of the tool's tip: below the surface, above 0; or of the floor, from the middle of the outline along `into`.
  double depth_mm = 1.0;
  double layer_mm = 1.0;      ///< of depth, at most
  double apart_mm = 1.0;      ///< between neighbouring lines, at most
  double feed_mm_s = 10.0;    ///< in bone
  double travel_mm_s = 40.0;  ///< from one line's end to another line's begin, over the bone
  double lift_mm = 3.0;       ///< how far above the highest bone of the patch
};

/// Throws Error on fewer than 3 corners, numbers that are not finite or out of range, a direction that is not unit, and
/// on lines or layers further apart than the tool is wide: they would leave ridges.
void check_milling(const Milling& milling, const DrillBit& bit);

struct MillingMotionOptions {
  double rate_hz = 1000.0;  ///< poses a second
  double tremor_mm = 0.0;   ///< Tremor's amplitude
  std::uint64_t seed = 1;   ///< of the tremor
};

/// An operator that mills as it is told, whatever it feels. Each pose is worked out from its index: no error adds up.
/// Ends at the end, or when the session asks to stop.
class MillingMotion final : public Operator {
 public:
  /// The tip goes in straight lines from one to the next.
  struct Knot {
    double time_s;
    Vec3 tip_mm;
  };

  /// `bone`: distance to its surface as it is (below 0 inside), asked here only. The first surface that is met on the
  /// way in counts, where it lies within 60 mm of the outline's middle. Throws Error as check_milling() does, where the
  /// patch holds no bone that is to be milled, and on over 2^27 poses.
  MillingMotion(const Milling& milling, const DrillBit& bit, const ScalarField& bone,
                const MillingMotionOptions& options = {});

  std::optional<ToolInput> next(const ToolFeedback& feedback) override;
  std::size_t count() const override { return poses_; }
  /// Index 0 is the start. Patient LPS, mm.
  Pose pose(std::size_t index) const;
  double rate_hz() const { return rate_hz_; }
  /// Of the tip's way in bone and from line to line, mm.
  double length_mm() const { return length_mm_; }

 private:
  PathFrame frame_;
  Tremor tremor_;
  bool trembles_;
  double rate_hz_;
  std::vector<Knot> knots_;
  double length_mm_ = 0.0;
  std::size_t poses_ = 0;
  std::size_t index_ = 0;
};

}  // namespace spinaltap

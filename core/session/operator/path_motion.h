#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/geometry.h"
#include "core/session/operator/operator.h"
#include "core/tool/path_curve.h"

namespace spinaltap {

/// An operator's tremor: 8 to 12 Hz, the band of physiological tremor. Along each of three axes the sum of five
/// sinusoids with seeded frequencies, one in each fifth of the band, and phases: it does not come back to where it was.
/// Computed from the time alone: no error adds up.
class Tremor {
 public:
  /// `amplitude_mm`: along each axis the rms is that of one sinusoid of this amplitude. Throws Error where it is not
  /// from 0 to 100 mm.
  Tremor(double amplitude_mm, std::uint64_t seed);

  /// The tip's displacement in path-local coordinates, mm.
  Vec3 at_mm(double time_s) const;

 private:
  static constexpr std::size_t kSinusoids = 5;

  double amplitude_mm_;  ///< of one sinusoid
  std::array<std::array<double, kSinusoids>, 3> phases_rad_{}, frequencies_hz_{};
};

/// How fast a bit is fed, by depth.
struct FeedStep {
  double from_mm = 0.0;  ///< depth from which on it holds, beyond the entry
  double mm_s = 1.0;
};

/// Going back now and then, to clear the chips and to cool.
struct Pecking {
  double every_mm = 0.0;  ///< of depth; 0: never
  double back_mm = 2.0;
  double mm_s = 20.0;    ///< back, and forward again until kSlowMm before where it was
  double pause_s = 0.0;  ///< that it waits where it has gone back to

  /// The last of the way back to uncut bone is gone at the feed of drilling: a bit that meets it fast is kicked.
  static constexpr double kSlowMm = 0.2;
};

/// A tip's feed by depth, its pecks and its way back.
struct FeedProfileOptions {
  /// In order of depth; the first one's feed holds before it too. Never empty.
  std::vector<FeedStep> steps{{0.0, 1.0}};
  Pecking pecking = {};
  double withdraw_mm_s = 0.0;  ///< from the end back to the begin; 0: stays
};

/// A tip's depth by time: from a begin to an end at given feeds. Worked out from the time alone: no error adds up.
class FeedProfile {
 public:
  /// Throws Error on feeds that are not above 0, depths that do not rise, pecks that lead nowhere or wait for no time,
  /// and over 2^20 moves.
  FeedProfile(double begin_mm, double end_mm, const FeedProfileOptions& options);

  /// Depth, mm. Before 0 s the begin's, after duration_s() that where it ends.
  double depth_mm(double time_s) const;
  double duration_s() const { return knots_.back().time_s; }

 private:
  /// Depth goes in straight lines from one to the next.
  struct Knot {
    double time_s;
    double depth_mm;
  };
  void go(double to_mm, double mm_s);
  void wait(double pause_s);

  std::vector<Knot> knots_;
};

/// The line that an operator guides a bit along, beside the path and as straight or curved as that.
struct GuideLine {
  double lead_in_mm = 0.0;  ///< how far before the entry it begins
  double offset_mm = 0.0;   ///< sideways shift from the path
  double tilt_deg = 0.0;    ///< between the bit and the path; lines meet (or pass) at the path's middle
};

/// Poses along a line, by depth. Of a curved path offset, tilt and tremor are in its path-local axes at each place, and
/// before its entry and past its target the line goes straight on.
class GuidedBit {
 public:
  /// Throws Error on a bad path, on a lead-in that is not 0 or more, offsets over 100 mm and tilts over 60 degrees; of
  /// curved paths also where the line would be as far off the path as its tightest bend's radius.
  GuidedBit(const DrillPath& path, const GuideLine& line);

  /// Depth at which the line begins and that of the target, mm beyond the entry along the line.
  double begin_mm() const { return begin_mm_; }
  double end_mm() const { return end_mm_; }
  /// Patient LPS. `aside_mm`: displaced by so much, in path-local coordinates.
  Pose at(double depth_mm, const Vec3& aside_mm = Vec3::Zero()) const;

 private:
  PathCurve curve_;
  PathFrame frame_;  ///< of a straight path
  Vec3 axis_path_;
  Vec3 middle_path_;  ///< at half the path's length
  Vec3 axis_;         ///< patient LPS, of a straight path
  double begin_mm_;
  double end_mm_;
};

/// A planned motion along a path.
struct PathMotionOptions {
  GuideLine line = {};
  double rate_hz = 1000.0;  ///< poses a second
  FeedProfileOptions feed = {};
  double tremor_mm = 0.0;  ///< Tremor's amplitude
  std::uint64_t seed = 1;  ///< of the tremor
};
/// The same feed all the way, given as the advance a cycle.
PathMotionOptions in_steps_of(double step_mm, const GuideLine& line = {});

/// Poses of a planned motion, each worked out from its index alone: no error adds up.
class PathMotion {
 public:
  /// Throws Error as its parts do, on rates that are not above 0 and on over 2^27 cycles.
  PathMotion(const DrillPath& path, const PathMotionOptions& options);

  std::size_t cycle_count() const { return cycles_; }
  double rate_hz() const { return rate_hz_; }
  /// Patient LPS, mm. Index 0 is the start, before the first cycle; cycle_count() is the end.
  Pose pose(std::size_t index) const;
  /// Depth of the tip beyond the entry, along the bit's line and but for the tremor, mm.
  double depth_mm(std::size_t index) const { return profile_.depth_mm(static_cast<double>(index) / rate_hz_); }
  /// Its tremor alone, mm, in path-local coordinates.
  Vec3 tremor_mm(std::size_t index) const;

 private:
  GuidedBit bit_;
  FeedProfile profile_;
  Tremor tremor_;
  bool trembles_;
  double rate_hz_;
  std::size_t cycles_ = 0;
};

/// An operator that goes its planned way, whatever it feels: on the path, beside it or tilted, at given feeds, with
/// pecks, with a tremor. Ends at the motion's end, or when the session asks to stop.
class PlannedMotion final : public Operator {
 public:
  PlannedMotion(const DrillPath& path, const PathMotionOptions& options) : motion_(path, options) {}

  std::optional<ToolInput> next(const ToolFeedback& feedback) override {
    if (feedback.stop || index_ > motion_.cycle_count()) return std::nullopt;
    return ToolInput{motion_.pose(index_++), true, 1.0 / motion_.rate_hz()};
  }
  std::size_t count() const override { return motion_.cycle_count() + 1; }

 private:
  PathMotion motion_;
  std::size_t index_ = 0;
};

}  // namespace spinaltap

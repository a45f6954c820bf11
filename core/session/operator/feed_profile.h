#pragma once

#include <cstddef>
#include <vector>

namespace spinaltap {

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

}  // namespace spinaltap

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/engine/detail/disc_kernels.h"

namespace spinaltap {

/// The line of a bit's axis over the discs: x(z), y(z), and how far back from the tip it meets the plane at z; mm.
/// Relative to a line that lies nearby, so that float keeps nanometres.
struct AxisLine {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double x_slope = 0.0;
  double y_slope = 0.0;
  double back_mm = 0.0;
  double back_slope = 0.0;
};

/// For every disc, how far the bit's axis may move before the bit can touch an occupied point there.
///
/// A disc's certificate was made at some line of the axis. It holds while
///   across_share |(dx, dy)| + turn_mm (|dx'| + |dy'|) + back_share * db + slack  <  free_mm
/// where dx, dy, db are how far the axis has moved since then in the disc's plane and back from the tip, and dx', dy'
/// how much it has turned. A bit that is a cone and a cylinder gets wider only where it advances: there db counts only
/// forward, and not at all for discs behind the cone, where the bit slides along its own wall. Other bits count it both
/// ways. Certificates that once failed stay failed until they are made anew, so that those which hold held all along.
class DiscCertificates {
 public:
  /// The bit's motion that all discs are checked against.
  struct Motion {
    AxisLine line;
    double across_share = 1.0;
    double turn_mm = 0.0;
    double slack_mm = 0.0;
    bool counts_backward = false;
  };

  DiscCertificates(std::size_t discs, double spacing_mm, const detail::DiscKernels& kernels);

  void fail_all();
  /// Marks the discs whose certificates do not hold at the end of this motion.
  void check(const Motion& motion) noexcept;
  /// One byte a disc: 0 where its certificate holds. The length is a whole number of words of 8.
  std::span<const std::uint8_t> due() const { return due_; }
  /// A certificate for a disc at `line`. It holds nowhere where `free_mm` is not above 0.
  void renew(int disc, const AxisLine& line, double free_mm, double back_share) noexcept;

  std::size_t memory_bytes() const;

 private:
  struct Columns {
    std::vector<float> free_mm, back_share, x_mm, y_mm, x_slope, y_slope, back_mm;
  };

  detail::DiscKernels kernels_;
  float spacing_mm_;
  Columns columns_;
  std::vector<std::uint8_t> due_;
};

}  // namespace spinaltap

// How large a level can be. Widths: spans of the transverse processes, means of Panjabi et al. 1991 (cervical, Spine
// 16:861; thoracic, 16:888) and 1992 (lumbar, 17:299) and three standard deviations, and the largest of 802 CTs from
// T11 to L5 (CTSpinoPelvic1K, morphometrics/level_gradients.csv). Volumes: at least a body of those papers' smallest
// endplates and heights, at most twice a whole vertebra of real CTs; distances of neighbours: heights of bodies and
// discs, by a third more or less. They are wide: what they exclude is another region of the spine, not a neighbour.

#include "core/ct/detail/label_shapes.h"

#include <array>

#include "core/base/error.h"

namespace spinaltap::detail {
namespace {

struct Limits {
  Level last;  ///< down to this level
  double max_width_mm;
  double min_cm3, max_cm3;
  double min_pitch_mm, max_pitch_mm;  ///< to the middle of the next below
};

constexpr std::array<Limits, 11> kLimits{{
    {Level::kC1, 105.0, 2.0, 25.0, 6.0, 30.0},     // C1
    {Level{2}, 80.0, 2.0, 25.0, 10.0, 30.0},       // C2
    {Level{6}, 75.0, 2.0, 20.0, 10.0, 25.0},       // C3 to C6
    {Level::kC7, 90.0, 2.0, 24.0, 11.0, 27.0},     // C7
    {Level::kT1, 92.0, 3.0, 32.0, 12.0, 28.0},     // T1
    {Level{11}, 86.0, 3.0, 32.0, 13.0, 29.0},      // T2 to T4
    {Level{15}, 80.0, 4.5, 42.0, 15.0, 33.0},      // T5 to T8
    {Level{17}, 82.0, 7.0, 58.0, 18.0, 38.0},      // T9, T10
    {Level::kT12, 88.0, 8.0, 80.0, 19.0, 45.0},    // T11, T12
    {Level{20}, 108.0, 11.0, 120.0, 24.0, 50.0},   // L1
    {Level::kL6, 125.0, 12.0, 140.0, 25.0, 75.0},  // L2 to L6; the sacrum's middle is far below L5's
}};
constexpr Limits kOfSacrum{Level::kSacrum, 150.0, 8.0, 500.0, 0.0, 1000.0};
constexpr Limits kOfT13{Level::kT13, 95.0, 8.0, 90.0, 19.0, 48.0};

constexpr double kMaxBodyWidthMm = 72.0;
constexpr double kMaxBodyDepthMm = 52.0;

const Limits& limits_of(Level level) {
  if (level == Level::kSacrum) return kOfSacrum;
  if (level == Level::kT13) return kOfT13;
  for (const Limits& limits : kLimits) {
    if (static_cast<int>(level) <= static_cast<int>(limits.last)) return limits;
  }
  return kLimits.back();
}

}  // namespace

std::optional<std::string> why_not(const LabelShape& shape, Level level, bool is_body) {
  const Limits& limits = limits_of(level);
  const double width_mm = shape.size_mm.x();
  const double cm3 = shape.volume_mm3 / 1000.0;
  if (is_body && level != Level::kSacrum && !(width_mm <= kMaxBodyWidthMm && shape.size_mm.y() <= kMaxBodyDepthMm)) {
    return joined(short_text(width_mm, 3), " x ", short_text(shape.size_mm.y(), 3), " mm, more than a body");
  }
  if (!(width_mm <= limits.max_width_mm)) {
    return joined(short_text(width_mm, 3), " mm across, at most ", limits.max_width_mm);
  }
  if (!(cm3 <= limits.max_cm3)) return joined(short_text(cm3, 3), " cm3, at most ", limits.max_cm3);
  if (!shape.is_cut && !(cm3 >= limits.min_cm3)) {
    return joined(short_text(cm3, 3), " cm3, at least ", limits.min_cm3);
  }
  return std::nullopt;
}

std::optional<std::string> why_not_neighbours(const LabelShape& upper, const LabelShape& lower, Level level) {
  if (upper.is_cut || lower.is_cut) return std::nullopt;
  const Limits& limits = limits_of(level);
  const double mm = (upper.middle_mm - lower.middle_mm).norm();
  if (mm >= limits.min_pitch_mm && mm <= limits.max_pitch_mm) return std::nullopt;
  return joined(short_text(mm, 3), " mm from the next below, expected ", limits.min_pitch_mm, " to ",
                limits.max_pitch_mm);
}

}  // namespace spinaltap::detail

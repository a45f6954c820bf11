#include "core/phantom/level_measures.h"

#include <array>

#include "core/base/error.h"
#include "core/base/lerp.h"

namespace spinaltap {
namespace {

/// Means of adults, rounded. Bodies' widths and depths, canals, spans of the transverse processes: Panjabi et al. 1991
/// (thoracic, Spine 16:888) and 1992 (lumbar, Spine 17:299). Heights: between those cadavers' and the medians of CTs,
/// which are 2 to 6 mm higher. Pedicles: Zindrick et al. 1987 (Spine 12:160); the widths of the lumbar ones lie amid 13
/// published series, as Zindrick's 18 mm of L5 are measured obliquely. Wedges: Masharawi et al. 2008 (Eur Spine J
/// 17:1336). Rise of the transverse processes: McCormack et al. 1995 (Neurosurgery 37:303). Processes, laminae, facets,
/// discs and the curve are drawn after textbooks. C3 to C7: Panjabi et al. 1991 (cervical, Spine 16:861), bodies a
/// little higher, as CTs have them.
// clang-format off
constexpr std::array<LevelMeasures, 22> kMeasures{{
    // body: w, d, h, wedge; pedicle: w, h, convergence; canal: w, d; transverse: span, back, rise;
    // spinous: length, drop, tip; lamina; facet: x, inward, upward; disc; flexion; lumbar share; cervical share
    {16.5, 15.3, 12.6,  1.0,   5.6,  7.4, 44.0,  22.9, 16.2,  50.3,-70.0, -1.0,  14.0, 14.0,  7.0,  10.5,  20.5,   0.0, 45.0,  5.0,  -4.0, 0.0, 1.0},
    {17.1, 15.6, 12.3,  1.0,   5.4,  7.4, 44.0,  24.7, 16.9,  49.5,-70.0, -1.0,  13.5, 14.0,  7.0,  10.5,  21.0,   0.0, 45.0,  5.0,   2.0, 0.0, 1.0},
    {18.4, 16.5, 12.0,  1.5,   5.6,  7.2, 43.0,  24.9, 16.8,  49.5,-70.0, -1.0,  13.5, 14.0,  7.0,  11.0,  21.5,   0.0, 44.0,  5.2,   8.0, 0.0, 1.0},
    {20.2, 17.3, 12.3,  1.5,   6.0,  7.4, 40.0,  25.8, 16.8,  51.0,-68.0, -1.0,  17.0, 17.0,  7.5,  12.0,  22.0,   0.0, 40.0,  5.2,  15.0, 0.0, 1.0},
    {22.6, 17.5, 13.6,  1.5,   6.6,  7.8, 35.0,  24.5, 16.5,  66.6,-25.0, -1.0,  29.5, 17.0,  9.0,  15.0,  20.5,   0.0, 38.0,  5.0,  21.0, 0.0, 1.0},
    {26.2, 19.1, 16.0,  2.0,   7.9,  9.9, 26.6,  21.8, 16.4,  75.3, 15.0,  3.5,  33.0, 18.0,  9.0,  19.5,  13.5, -10.0, 25.0,  3.0,  24.0, 0.0},
    {26.2, 20.6, 17.0,  2.5,   7.0, 11.5, 19.1,  19.5, 15.5,  69.8, 24.0,  3.0,  32.0, 28.0,  8.0,  20.5,  12.5, -12.0, 20.0,  3.0,  20.5, 0.0},
    {25.3, 23.0, 17.5,  3.0,   5.6, 12.0, 16.6,  18.1, 15.8,  62.4, 31.0,  2.0,  31.0, 36.0,  7.5,  21.5,  11.5, -12.0, 18.0,  3.0,  17.0, 0.0},
    {25.3, 23.9, 18.0,  3.0,   4.7, 11.8, 13.8,  17.0, 16.1,  60.6, 35.0,  1.5,  32.0, 45.0,  7.0,  22.5,  11.0, -12.0, 15.0,  3.2,  13.0, 0.0},
    {26.0, 25.1, 18.5,  3.5,   4.5, 11.9, 11.0,  17.2, 16.2,  61.2, 38.0,  1.0,  35.0, 53.0,  7.0,  23.5,  11.0, -12.0, 15.0,  3.5,   9.5, 0.0},
    {27.2, 26.5, 19.0,  4.0,   5.2, 12.2,  9.0,  17.3, 16.0,  61.0, 40.0,  0.5,  38.0, 57.0,  7.0,  24.5,  11.0, -12.0, 15.0,  4.0,   5.5, 0.0},
    {28.5, 28.0, 19.5,  4.0,   5.3, 12.1,  8.5,  17.3, 15.8,  60.9, 42.0, -0.5,  40.0, 58.0,  7.0,  25.0,  11.0, -12.0, 15.0,  4.2,   1.5, 0.0},
    {30.0, 28.7, 20.0,  4.0,   5.9, 12.5,  7.7,  17.7, 15.9,  60.4, 43.0, -1.0,  39.0, 57.0,  7.0,  26.0,  11.0, -12.0, 15.0,  4.5,  -2.5, 0.0},
    {31.8, 30.2, 21.0,  3.5,   6.1, 13.5,  7.6,  17.9, 15.7,  59.6, 44.0, -1.5,  36.0, 50.0,  7.5,  27.0,  11.0, -12.0, 15.0,  5.0,  -6.5, 0.0},
    {33.7, 31.1, 22.0,  3.5,   6.3, 14.5,  4.6,  18.2, 15.5,  58.4, 45.0, -2.0,  32.0, 38.0,  9.0,  27.5,  11.2, -10.0, 14.0,  5.5, -10.0, 0.0},
    {37.0, 31.9, 23.5,  4.0,   7.8, 16.5,  1.2,  19.4, 16.1,  52.0, 47.0, -3.0,  29.0, 25.0, 13.0,  27.5,  11.5,  -8.0, 12.0,  6.0, -13.5, 0.25},
    {40.6, 33.1, 25.0,  4.0,   7.1, 15.8, -4.2,  22.2, 18.1,  46.9, 45.0, -4.0,  28.0, 12.0, 16.0,  26.0,  12.0,  -5.0, 10.0,  7.0, -16.0, 0.5},
    {42.3, 34.7, 26.5,  2.5,   7.6, 15.4, 10.9,  23.7, 19.0,  71.2, 16.0, -1.5,  30.0,  8.0, 20.0,  25.0,  15.0,  58.0,  0.0,  8.0, -17.0, 1.0},
    {44.1, 34.8, 27.5,  0.5,   7.9, 15.0, 12.0,  23.8, 18.2,  76.1, 14.0, -1.0,  31.0,  6.0, 22.0,  24.5,  16.0,  55.0,  0.0,  9.0, -13.0, 1.0},
    {46.1, 35.0, 28.0, -1.5,   9.5, 14.9, 14.4,  24.3, 17.5,  85.7, 12.0,  0.0,  31.0,  5.0, 23.0,  22.5,  17.5,  50.0,  0.0, 10.0,  -5.0, 1.0},
    {48.1, 34.7, 28.0, -3.0,  11.3, 14.8, 17.7,  25.4, 18.6,  79.4, 12.0,  0.0,  28.0,  5.0, 20.0,  20.0,  20.0,  45.0,  0.0, 10.5,   5.0, 1.0},
    {48.4, 34.0, 27.5, -9.0,  13.6, 14.6, 25.0,  27.1, 19.7,  84.6, 10.0,  0.0,  23.0, 10.0, 15.0,  17.0,  22.5,  38.0,  0.0,  9.5,  18.0, 1.0},
}};
// clang-format on

}  // namespace

LevelMeasures mixed(const LevelMeasures& a, const LevelMeasures& b, double share) {
  LevelMeasures m = a;
  for (double LevelMeasures::*const value : {&LevelMeasures::body_width_mm,
                                             &LevelMeasures::body_depth_mm,
                                             &LevelMeasures::body_height_mm,
                                             &LevelMeasures::wedge_deg,
                                             &LevelMeasures::pedicle_width_mm,
                                             &LevelMeasures::pedicle_height_mm,
                                             &LevelMeasures::pedicle_convergence_deg,
                                             &LevelMeasures::canal_width_mm,
                                             &LevelMeasures::canal_depth_mm,
                                             &LevelMeasures::transverse_span_mm,
                                             &LevelMeasures::transverse_back_deg,
                                             &LevelMeasures::transverse_rise_mm,
                                             &LevelMeasures::spinous_length_mm,
                                             &LevelMeasures::spinous_drop_deg,
                                             &LevelMeasures::spinous_tip_height_mm,
                                             &LevelMeasures::lamina_height_mm,
                                             &LevelMeasures::facet_x_mm,
                                             &LevelMeasures::facet_inward_deg,
                                             &LevelMeasures::facet_upward_deg,
                                             &LevelMeasures::disc_below_mm,
                                             &LevelMeasures::flexion_deg,
                                             &LevelMeasures::lumbar_share}) {
    m.*value = lerp(a.*value, b.*value, share);
  }
  return m;
}

const LevelMeasures& level_measures(Level level) {
  const int first = static_cast<int>(kFirstMeasured), last = static_cast<int>(kLastMeasured);
  const int number = static_cast<int>(level);
  if (number < first || number > last) {
    fail("spine phantom: levels from ", level_name(kFirstMeasured), " to ", level_name(kLastMeasured),
         " have measures, found ", level == Level::kNone ? "none" : level_name(level));
  }
  return kMeasures[static_cast<std::size_t>(number - first)];
}

}  // namespace spinaltap

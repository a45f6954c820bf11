// Compiled with optimisation: whole CTs are gone through.
#include "tests/trunks/doubt_figures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/trunks/mask_rim.h"

namespace spinaltap::test {
namespace {

/// Logarithms of how many times as large a body is as its neighbours that are whole, the least of both, without sign.
Vec3 unlike_neighbours(const SpineSegmentation& found, std::size_t index) {
  Vec3 least = Vec3::Zero();
  bool is_first = true;
  for (const std::size_t other : {index - 1, index + 1}) {
    if (other >= found.levels.size() || found.levels[other].is_cut) continue;
    const Vec3 ratio = found.levels[index].body_size_mm.cwiseQuotient(found.levels[other].body_size_mm);
    const Vec3 off = ratio.array().log().abs();
    least = is_first ? off : Vec3(least.cwiseMin(off));
    is_first = false;
  }
  return least;
}

/// Area of cuts that no gap shows, from one kind of contact to another.
double cuts_mm2(const LevelFigures& figures, Contact first, Contact last) {
  double sum_mm2 = 0.0;
  for (auto n = static_cast<std::size_t>(first); n <= static_cast<std::size_t>(last); ++n)
    sum_mm2 += figures.bridges[n].mm2;
  return sum_mm2;
}

}  // namespace

DoubtFigures doubt_figures(const CtVolume& ct, const SpineSegmentation& found, std::size_t index) {
  const LevelReport& report = found.levels[index];
  const LevelFigures& figures = report.figures;
  const Vec3& size_mm = report.body_size_mm;
  const double endplate_mm2 = std::numbers::pi / 4.0 * size_mm.x() * size_mm.y();
  const double body_mm3 = endplate_mm2 * size_mm.z();
  const Vec3 unlike = unlike_neighbours(found, index);
  const MaskRim rim = measure_rim(ct, found.labels, report);
  return {
      ct.geometry.spacing_mm.maxCoeff(),
      found.bone.noise_hu,
      found.bone.sure_threshold_hu - found.bone.threshold_hu,
      1.0 - report.body_fit,
      report.is_cut ? 1.0 : 0.0,
      std::log(size_mm.z() / size_mm.y()),
      unlike.z(),
      unlike.x(),
      unlike.y(),
      index == 0 || index + 1 == found.levels.size() ? 1.0 : 0.0,
      figures.unsure_share,
      cuts_mm2(figures, Contact::upper_left, Contact::right_rib) / endplate_mm2,
      cuts_mm2(figures, Contact::body_above, Contact::beside) / endplate_mm2,
      std::abs(figures.left_share - 0.5),
      std::abs(figures.left_reach_mm - figures.right_reach_mm) / size_mm.x(),
      figures.lopsided_mm3 / body_mm3,
      std::min(figures.left_pedicle_mm2, figures.right_pedicle_mm2) / endplate_mm2,
      1.0 - figures.canal_closed,
      figures.behind_canal_mm / size_mm.y(),
      std::log(std::max(report.volume_mm3, 1.0) / body_mm3),
      rim.inside_hu - found.bone.threshold_hu,
      found.bone.threshold_hu - rim.outside_hu,
      rim.inner_hu - found.bone.threshold_hu,
      report.severity,
  };
}

}  // namespace spinaltap::test

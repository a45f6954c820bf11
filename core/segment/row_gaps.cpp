#include "core/segment/row_gaps.h"

#include <cmath>

#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

std::string at_height(const Vec3& p_mm) { return joined("z ", std::lround(p_mm.z()), " mm"); }

/// How far the canal goes on past the plane across it at a body's middle, on the side of `outward`.
struct Beyond {
  double mm = 0.0;
  Vec3 end_mm = Vec3::Zero();
};
Beyond canal_beyond(const SpinalCanal& canal, const Vec3& middle_mm, const Vec3& outward) {
  Beyond beyond;
  const Vec3* last = nullptr;
  const auto count = static_cast<std::ptrdiff_t>(canal.points_mm.size());
  const bool is_up = outward.z() > 0.0;
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const Vec3& p_mm = canal.points_mm[static_cast<std::size_t>(is_up ? n : count - 1 - n)];
    if ((p_mm - middle_mm).dot(outward) < 0.0) continue;
    if (last != nullptr) beyond.mm += (p_mm - *last).norm();
    last = &p_mm;
  }
  if (last != nullptr) beyond.end_mm = *last;
  return beyond;
}

}  // namespace

std::vector<std::string> gaps_in_row(const SpineBodies& spine) {
  std::vector<std::string> gaps;
  const std::size_t count = spine.chain.size();
  if (count < 2) return gaps;
  const auto middle_mm = [&](std::size_t n) { return spine.bodies[n].cylinder.centre_mm; };
  const auto step_mm = [&](std::size_t lower) { return (middle_mm(lower + 1) - middle_mm(lower)).norm(); };
  // From below: between neighbours. Discs are up to half as high as their bodies, and a crushed body leaves more.
  constexpr double kMinGapOverHeight = 0.9;
  for (std::size_t n = 0; n + 1 < count; ++n) {
    const double height_mm = 0.5 * (spine.chain[n].height_mm() + spine.chain[n + 1].height_mm());
    const double gap_mm = (spine.chain[n + 1].lower.centre_mm - spine.chain[n].upper.centre_mm).norm();
    if (gap_mm < kMinGapOverHeight * height_mm) continue;
    gaps.push_back(joined("a body may be missed between ", at_height(middle_mm(n + 1)), " and ",
                          at_height(middle_mm(n)), ": ", std::lround(gap_mm), " mm lie between two of ",
                          std::lround(height_mm), " mm"));
  }
  // Half a vertebra belongs to the outermost body itself, half a one may be cut by the CT's border or the canal's end.
  constexpr double kMinVertebrae = 2.0;
  const auto check_end = [&](std::size_t end, double vertebra_mm, const Vec3& outward, const char* side) {
    if (spine.chain[end].lower.is_cut || spine.chain[end].upper.is_cut) return;
    const Beyond beyond = canal_beyond(spine.canal, middle_mm(end), outward);
    if (beyond.mm < kMinVertebrae * vertebra_mm) return;
    gaps.push_back(joined("vertebrae may be missed ", side, " the row: it ends at ", at_height(middle_mm(end)),
                          ", the canal goes on to ", at_height(beyond.end_mm), ", vertebrae are ",
                          std::lround(vertebra_mm), " mm apart"));
  };
  check_end(count - 1, step_mm(count - 2), spine.bodies[count - 1].cylinder.axes().col(2), "above");
  if (!spine.has_sacrum) check_end(0, step_mm(0), -spine.bodies[0].cylinder.axes().col(2), "below");
  return gaps;
}

}  // namespace spinaltap

#include "core/segment/row_gaps.h"

#include <cmath>
#include <utility>
#include <vector>

#include "core/base/text_writer.h"
#include "core/segment/detail/median.h"

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

Vec3 middle_mm(const SpineBodies& spine, std::size_t n) { return spine.bodies[n].cylinder.centre_mm; }

/// Between a body and the next above, middle to middle and end to end.
double step_mm(const SpineBodies& spine, std::size_t lower) {
  return (middle_mm(spine, lower + 1) - middle_mm(spine, lower)).norm();
}
double gap_mm(const SpineBodies& spine, std::size_t lower) {
  return (spine.chain[lower + 1].lower.centre_mm - spine.chain[lower].upper.centre_mm).norm();
}

double mean_height_mm(const SpineBodies& spine, std::size_t lower) {
  return 0.5 * (spine.chain[lower].height_mm() + spine.chain[lower + 1].height_mm());
}

/// The median of what is measured between all neighbours: of two the less, for the other may be a gap's.
template <class Measure>
double median_between(const SpineBodies& spine, const Measure& measure) {
  std::vector<double> all;
  for (std::size_t n = 0; n + 1 < spine.chain.size(); ++n) all.push_back(measure(spine, n));
  return detail::lower_median(std::move(all));
}

/// The longer step of the pairs beside one; of an outermost pair nothing.
std::optional<double> step_beside_mm(const SpineBodies& spine, std::size_t lower) {
  const std::size_t lowest = spine.has_sacrum ? 1 : 0, highest = spine.chain.size() - 2;
  if (lower <= lowest || lower >= highest) return std::nullopt;
  return std::max(step_mm(spine, lower - 1), step_mm(spine, lower + 1));
}

/// Whether two neighbours' middles lie so much further apart than those of the pairs beside them that both may have
/// taken a part of one between them.
bool is_long_step(const SpineBodies& spine, std::size_t lower) {
  // From one pair to the next steps grow by up to 1.2; a body between two makes them 1.35 times as long and more.
  constexpr double kLong = 1.3;
  const std::optional<double> beside_mm = step_beside_mm(spine, lower);
  return beside_mm && step_mm(spine, lower) >= kLong * *beside_mm;
}

/// Whether there is room for a body between one and the next above. Discs are up to half as high as their bodies, and a
/// crushed body has room in less, where the row's discs are thin.
bool has_room_above(const SpineBodies& spine, std::size_t lower) {
  constexpr double kBodyOverHeight = 0.9, kCrushedOverHeight = 0.6, kCrushedOverDisc = 2.5;
  const double room_mm = gap_mm(spine, lower), height_mm = mean_height_mm(spine, lower);
  if (room_mm >= kBodyOverHeight * height_mm) return true;
  return room_mm >= kCrushedOverHeight * height_mm && room_mm >= kCrushedOverDisc * median_between(spine, gap_mm);
}

/// Whether a whole body is so much higher than its whole neighbours, of an outermost one the next two, than every one,
/// that it may be two.
bool may_be_two(const SpineBodies& spine, std::size_t n) {
  // From T1 to L5 a body is up to 1.25 times as high as the next; two with one crushed to half make 1.6.
  constexpr double kTwo = 1.45;
  const std::size_t count = spine.chain.size();
  if (count < 3 || spine.chain[n].is_cut()) return false;
  const std::size_t first = n == 0           ? 1
                            : n + 1 == count ? n - 2
                                             : n - 1,
                    last = n == 0           ? 2
                           : n + 1 == count ? n - 1
                                            : n + 1;
  for (std::size_t other = first; other <= last; ++other) {
    if (other == n) continue;
    if (spine.chain[other].is_cut() || spine.chain[n].height_mm() < kTwo * spine.chain[other].height_mm()) return false;
  }
  return true;
}

}  // namespace

std::optional<int> bodies_missing_above(const SpineBodies& spine, std::size_t lower) {
  if (may_be_two(spine, lower) || may_be_two(spine, lower + 1)) return std::nullopt;
  if (!has_room_above(spine, lower)) return is_long_step(spine, lower) ? std::nullopt : std::optional(0);
  constexpr double kMaxOff = 0.25;
  constexpr int kMost = 2;  // steps change along a spine
  const double steps = step_mm(spine, lower) / median_between(spine, step_mm);
  const int missing = static_cast<int>(std::lround(steps)) - 1;
  if (missing < 1 || missing > kMost || std::abs(steps - std::round(steps)) > kMaxOff) return std::nullopt;
  return missing;
}

std::vector<std::string> gaps_in_row(const SpineBodies& spine) {
  std::vector<std::string> gaps;
  const std::size_t count = spine.chain.size();
  if (count < 2) return gaps;
  // From below: between neighbours.
  for (std::size_t n = 0; n + 1 < count; ++n) {
    const bool has_room = has_room_above(spine, n);
    if (!has_room && !is_long_step(spine, n)) continue;
    const std::string why =
        has_room ? joined(std::lround(gap_mm(spine, n)), " mm lie between two of ",
                          std::lround(mean_height_mm(spine, n)), " mm")
                 : joined("their middles are ", std::lround(step_mm(spine, n)), " mm apart, those beside them up to ",
                          std::lround(*step_beside_mm(spine, n)), " mm");
    gaps.push_back(joined("a body may be missed between ", at_height(middle_mm(spine, n + 1)), " and ",
                          at_height(middle_mm(spine, n)), ": ", why));
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (!may_be_two(spine, n)) continue;
    gaps.push_back(joined("a body at ", at_height(middle_mm(spine, n)), " is ", std::lround(spine.chain[n].height_mm()),
                          " mm high, much higher than its neighbours: it may be two"));
  }
  // Half a vertebra belongs to the outermost body itself, half a one may be cut by the CT's border or the canal's end.
  constexpr double kMinVertebrae = 2.0;
  const auto check_end = [&](std::size_t end, double vertebra_mm, const Vec3& outward, const char* side) {
    if (spine.chain[end].is_cut()) return;
    const Beyond beyond = canal_beyond(spine.canal, middle_mm(spine, end), outward);
    if (beyond.mm < kMinVertebrae * vertebra_mm) return;
    gaps.push_back(joined("vertebrae may be missed ", side, " the row: it ends at ", at_height(middle_mm(spine, end)),
                          ", the canal goes on to ", at_height(beyond.end_mm), ", vertebrae are ",
                          std::lround(vertebra_mm), " mm apart"));
  };
  check_end(count - 1, step_mm(spine, count - 2), spine.bodies[count - 1].cylinder.axes().col(2), "above");
  if (!spine.has_sacrum) check_end(0, step_mm(spine, 0), -spine.bodies[0].cylinder.axes().col(2), "below");
  return gaps;
}

}  // namespace spinaltap

#include "core/phantom/spine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/phantom/detail/make_spine.h"
#include "core/phantom/detail/shapes.h"

namespace spinaltap {
namespace {

constexpr std::size_t kMaxParts = 96;
constexpr double kCutEdge = 0.6;    ///< mm over which an edge that a cut leaves is rounded
constexpr double kSpurBlend = 1.5;  ///< reach of the fillet between a spur and its body, mm

double spur_value_mm(const Spur& spur, const Vec3& p) {
  const double rod = segment_distance_mm(p, spur.root_mm, spur.tip_mm) - spur.radius_mm;
  return std::max(rod, spur.plane_normal.dot(p) - spur.plane_offset_mm);
}

Box3 box_of(const SpinePart& part) {
  Box3 box = part.solid->bounds_mm();
  for (const Spur& spur : part.spurs) {
    // Fillets reach at most a quarter of their blend beyond.
    const Vec3 room = Vec3::Constant(spur.radius_mm + 0.25 * kSpurBlend);
    for (const Vec3& end : {spur.root_mm, spur.tip_mm}) box.extend(end - room).extend(end + room);
  }
  return box;
}

}  // namespace

/// The parts' values at one point, each worked out when it is first asked for.
class Spine::Values {
 public:
  Values(const Spine& spine, const Vec3& p) : spine_(spine), p_(p) {
    for (std::size_t n = 0; n < spine.parts_.size(); ++n) {
      way_[n] = spine.boxes_[n].exteriorDistance(p);
      raw_[n] = std::numeric_limits<double>::quiet_NaN();
    }
  }

  /// Distance to a part's bounds, which its value is never below.
  double way_mm(std::size_t n) const { return way_[n]; }

  double value_mm(std::size_t n) {
    const SpinePart& part = spine_.parts_[n];
    double value = raw_mm(n);
    for (const SpinePart::Cut& cut : part.cuts) {
      // Where this holds the other part is too far to change anything.
      if (way_[cut.part] >= cut.gap_mm + kCutEdge - value) continue;
      value = shapes::smooth_max(value, cut.gap_mm - raw_mm(cut.part), kCutEdge);
    }
    for (const Spur& spur : part.spurs) value = shapes::smooth_min(value, spur_value_mm(spur, p_), kSpurBlend);
    return way_[n] > 0.0 ? std::max(value, way_[n]) : value;
  }

 private:
  double raw_mm(std::size_t n) {
    if (std::isnan(raw_[n])) spine_.parts_[n].solid->evaluate({&p_, 1}, {&raw_[n], 1}, {});
    return raw_[n];
  }

  const Spine& spine_;
  const Vec3& p_;
  std::array<double, kMaxParts> way_, raw_;
};

Spine::Spine(std::vector<SpinePart> parts) : parts_(std::move(parts)) { finish(); }

Spine::Spine(const SpineOptions& options) : placed_(place_levels(options)) {
  parts_ = make_parts(options, placed_);
  finish();
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    if (parts_[n].vertebra) check_isthmuses(*parts_[n].vertebra, [&](const Vec3& p) { return part_value_mm(n, p); });
  }
}

void Spine::finish() {
  if (parts_.empty() || parts_.size() > kMaxParts) {
    fail("spine phantom: 1 to ", kMaxParts, " bodies expected, found ", parts_.size());
  }
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    for (const SpinePart::Cut& cut : parts_[n].cuts) {
      if (cut.part >= parts_.size() || cut.part == n) fail("spine phantom: body ", n, " cannot be cut by ", cut.part);
    }
    boxes_.push_back(box_of(parts_[n]));
    bounds_.extend(boxes_.back());
  }
}

Spine::Nearest Spine::nearest(const Vec3& p) const {
  Values values(*this, p);
  std::size_t first = 0;
  for (std::size_t n = 1; n < parts_.size(); ++n) {
    if (values.way_mm(n) < values.way_mm(first)) first = n;
  }
  Nearest best{values.value_mm(first), first};
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    if (n == first || values.way_mm(n) > best.value_mm) continue;
    const double value = values.value_mm(n);
    if (value < best.value_mm || (value == best.value_mm && n < best.part)) best = {value, n};
  }
  return best;
}

void Spine::evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3> gradients) const {
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    const Vec3& p = points_mm[n];
    values_mm[n] = nearest(p).value_mm;
    if (gradients.empty()) continue;
    gradients[n] = shapes::slope_of([this](const Vec3& q) { return nearest(q).value_mm; }, p);
  }
}

double Spine::hu(const Vec3& p_patient, double distance_mm, double aperture_mm) const {
  // Where only one body's bounds are near, it is that one.
  std::size_t near = parts_.size();
  bool alone = true;
  for (std::size_t n = 0; n < parts_.size() && alone; ++n) {
    if (boxes_[n].exteriorDistance(p_patient) > std::max(distance_mm, 0.0)) continue;
    alone = near == parts_.size();
    near = n;
  }
  if (!alone || near == parts_.size()) near = nearest(p_patient).part;
  return parts_[near].solid->hu(p_patient, distance_mm, aperture_mm);
}

double Spine::part_value_mm(std::size_t n, const Vec3& p_patient) const { return Values(*this, p_patient).value_mm(n); }

std::optional<std::size_t> Spine::part_of(Level level) const {
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    if (parts_[n].label == static_cast<std::uint8_t>(level)) return n;
  }
  return std::nullopt;
}

std::uint8_t Spine::label_at(const Vec3& p_patient) const {
  const Nearest found = nearest(p_patient);
  return found.value_mm < 0.0 ? parts_[found.part].label : std::uint8_t{0};
}

}  // namespace spinaltap

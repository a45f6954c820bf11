#include "core/session/operator/milling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/error.h"
#include "core/tool/plate.h"

namespace spinaltap {
namespace {

constexpr double kNoSurface = std::numeric_limits<double>::quiet_NaN();
/// How far from the outline's middle, along the way in, a surface may lie.
constexpr double kMilledReachMm = 60.0;
/// Between places of a line.
constexpr double kSampleMm = 0.25;
/// Of all lines; of all knots.
constexpr std::size_t kMaxPlaces = 40'000, kMaxKnots = 4'000'000;
/// What a column of the bone is looked through by: thinner walls are found where they are no thinner than this.
constexpr double kColumnStepMm = 0.2;

void check_milled_range(double value, double low, double high, const char* what) {
  if (!(value >= low && value <= high)) {
    fail("milling: expected ", what, " from ", low, " to ", high, " mm, found ", value);
  }
}

/// A place of a line, in the milling's frame: z along the way in.
struct MilledPlace {
  double x = 0.0, y = 0.0;
  double surface_mm = kNoSurface;  ///< its z
};
using MilledLine = std::vector<MilledPlace>;

std::vector<Eigen::Vector2d> flattened(const std::vector<Vec3>& corners) {
  std::vector<Eigen::Vector2d> all;
  all.reserve(corners.size());
  for (const Vec3& corner : corners) all.emplace_back(corner.x(), corner.y());
  return all;
}

void add_places(const Eigen::Vector2d& from, const Eigen::Vector2d& to, MilledLine& line) {
  const auto steps = static_cast<int>(std::ceil((to - from).norm() / kSampleMm));
  for (int n = 0; n <= steps; ++n) {
    const Eigen::Vector2d at = from + (to - from) * (steps > 0 ? static_cast<double>(n) / steps : 0.0);
    line.push_back({at.x(), at.y()});
  }
}

void check_places(std::size_t count) {
  if (count > kMaxPlaces) fail("milling: expected a smaller patch, or lines further apart: its lines are over 10 m");
}

/// Lines along x, `apart_mm` from one another at most, where they lie within the outline.
std::vector<MilledLine> raster_lines(const std::vector<Eigen::Vector2d>& outline, double apart_mm) {
  double low = outline[0].y(), high = low;
  for (const auto& corner : outline) {
    low = std::min(low, corner.y());
    high = std::max(high, corner.y());
  }
  const auto count = static_cast<int>(std::max(1.0, std::ceil((high - low) / apart_mm)));
  std::vector<MilledLine> lines;
  std::size_t places = 0;
  for (int n = 0; n < count; ++n) {
    const double y = low + (high - low) * (n + 0.5) / count;
    std::vector<double> crossings;
    for (std::size_t corner = 0; corner < outline.size(); ++corner) {
      const Eigen::Vector2d& a = outline[corner];
      const Eigen::Vector2d& b = outline[(corner + 1) % outline.size()];
      if ((a.y() <= y) == (b.y() <= y)) continue;
      crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    }
    std::sort(crossings.begin(), crossings.end());
    MilledLine line;
    for (std::size_t pair = 0; pair + 1 < crossings.size(); pair += 2) {
      add_places({crossings[pair], y}, {crossings[pair + 1], y}, line);
    }
    check_places(places += line.size());
    if (!line.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

MilledLine contour_line(const std::vector<Eigen::Vector2d>& outline) {
  MilledLine line;
  for (std::size_t n = 0; n < outline.size(); ++n) {
    add_places(outline[n], outline[(n + 1) % outline.size()], line);
    check_places(line.size());
  }
  return line;
}

/// Finds where each place's column first meets the bone.
void find_surface_of(const PathFrame& frame, const ScalarField& bone, MilledLine& line) {
  constexpr auto kLooks = static_cast<std::size_t>(2.0 * kMilledReachMm / kColumnStepMm) + 1;
  std::vector<Vec3> points(kLooks);
  std::vector<double> values(kLooks);
  for (MilledPlace& place : line) {
    for (std::size_t n = 0; n < kLooks; ++n) {
      points[n] = frame.to_patient(Vec3(place.x, place.y, -kMilledReachMm + kColumnStepMm * static_cast<double>(n)));
    }
    bone.evaluate(points, values, {});
    for (std::size_t n = 0; n < kLooks; ++n) {
      if (!(values[n] < 0.0)) continue;
      const double share = n > 0 ? values[n - 1] / (values[n - 1] - values[n]) : 1.0;
      place.surface_mm = -kMilledReachMm + kColumnStepMm * (static_cast<double>(n) - 1.0 + share);
      break;
    }
  }
}

/// At the outline's middle, with the way in along z.
PathFrame milling_frame(const Milling& milling) {
  const Vec3 middle_mm = std::accumulate(milling.outline_mm.begin(), milling.outline_mm.end(), Vec3(Vec3::Zero())) /
                         static_cast<double>(milling.outline_mm.size());
  return {middle_mm, milling.into};
}

/// The direction of the outline's longest extent: unit.
Eigen::Vector2d longest_extent(const std::vector<Eigen::Vector2d>& outline) {
  // Of the outline's edges, which are even stretches of it, unlike its corners.
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double length = 0.0;
  const auto visit = [&](const auto& take) {
    for (std::size_t n = 0; n < outline.size(); ++n) {
      const Eigen::Vector2d& a = outline[n];
      const Eigen::Vector2d& b = outline[(n + 1) % outline.size()];
      take(a, b, (b - a).norm());
    }
  };
  visit([&](const auto& a, const auto& b, double weight) {
    middle += 0.5 * weight * (a + b);
    length += weight;
  });
  if (!(length > 0.0)) return Eigen::Vector2d::UnitX();
  middle /= length;
  visit([&](const auto& a, const auto& b, double weight) {
    for (const Eigen::Vector2d& at : {Eigen::Vector2d(a), Eigen::Vector2d(b), Eigen::Vector2d(0.5 * (a + b))}) {
      spread += weight * (at - middle) * (at - middle).transpose();
    }
  });
  const double angle = 0.5 * std::atan2(2.0 * spread(0, 1), spread(0, 0) - spread(1, 1));
  return {std::cos(angle), std::sin(angle)};
}

/// Lays the tip's way, in the milling's frame.
class MillingPlanner {
 public:
  MillingPlanner(const Milling& milling, const ScalarField& bone) : milling_(milling), frame_(milling_frame(milling)) {
    std::vector<Vec3> corners;
    for (const Vec3& corner : milling.outline_mm) corners.push_back(frame_.to_path(corner));
    std::vector<Eigen::Vector2d> outline = flattened(corners);
    along_ = longest_extent(outline);
    for (Eigen::Vector2d& corner : outline) corner = turned(corner, 1.0);
    if (milling.way == Milling::Way::contour) {
      lines_.push_back(contour_line(outline));
    } else {
      lines_ = raster_lines(outline, milling.apart_mm);
    }
    for (MilledLine& line : lines_) {
      for (MilledPlace& place : line) {
        const Eigen::Vector2d at = turned({place.x, place.y}, -1.0);
        place.x = at.x();
        place.y = at.y();
      }
      find_surface_of(frame_, bone, line);
      for (const MilledPlace& place : line) {
        if (std::isnan(place.surface_mm)) continue;
        highest_mm_ = std::min(highest_mm_, place.surface_mm);
      }
    }
  }

  const PathFrame& frame() const { return frame_; }

  std::vector<MillingMotion::Knot> knots(double& length_mm) {
    const bool follows = milling_.depth == Milling::Depth::below_surface;
    const double deep_mm = follows ? milling_.depth_mm : milling_.depth_mm - highest_mm_;
    if (std::isinf(highest_mm_) || !(deep_mm > 0.0)) {
      fail("milling: expected bone within 60 mm of the patch, along the way in, and above the floor; found none");
    }
    const auto layers = static_cast<int>(std::ceil(deep_mm / milling_.layer_mm - 1e-9));
    std::size_t places = 0;
    for (const MilledLine& line : lines_) places += line.size();
    if (places * static_cast<std::size_t>(layers) > kMaxKnots) {
      fail("milling: expected a smaller patch, or thicker layers: its lines are over 1 km");
    }
    for (int layer = 1; layer <= layers; ++layer) {
      const double layer_mm = std::min(deep_mm, layer * milling_.layer_mm);
      for (std::size_t n = 0; n < lines_.size(); ++n) {
        // From the last layer's end back, and every other line the other way.
        const bool goes_back = layer % 2 == 0;
        const MilledLine& line = lines_[goes_back ? lines_.size() - 1 - n : n];
        mill(line, layer_mm, (n + static_cast<std::size_t>(layer)) % 2 == 0);
      }
    }
    lift();
    length_mm = milled_mm_;
    return std::move(knots_);
  }

 private:
  /// Between the frame's axes and those along and across the longest extent.
  Eigen::Vector2d turned(const Eigen::Vector2d& at, double way) const {
    return {along_.x() * at.x() + way * along_.y() * at.y(), along_.x() * at.y() - way * along_.y() * at.x()};
  }

  void mill(const MilledLine& line, double layer_mm, bool backwards) {
    for (std::size_t n = 0; n < line.size(); ++n) {
      const MilledPlace& place = line[backwards ? line.size() - 1 - n : n];
      const bool follows = milling_.depth == Milling::Depth::below_surface;
      const double z_mm = (follows ? place.surface_mm : highest_mm_) + layer_mm;
      if (!(place.surface_mm <= z_mm)) continue;  // no bone, or none so high
      go_to({place.x, place.y, z_mm});
    }
  }

  void go_to(const Vec3& tip_mm) {
    if (knots_.empty()) {
      begin({tip_mm.x(), tip_mm.y(), highest_mm_ - milling_.lift_mm});
    } else {
      // As far as a neighbouring line lies the tool goes within the layer; further it goes over the bone.
      const Vec3 way = tip_mm - last_mm_;
      if (std::hypot(way.x(), way.y()) > 1.5 * std::max(milling_.apart_mm, kSampleMm)) lift();
    }
    if (is_lifted_) {
      // Down to where it was not yet, with room.
      const double above_mm =
          std::max(highest_mm_ - milling_.lift_mm, tip_mm.z() - milling_.layer_mm - milling_.lift_mm);
      add({tip_mm.x(), tip_mm.y(), last_mm_.z()}, milling_.travel_mm_s);
      add({tip_mm.x(), tip_mm.y(), std::min(above_mm, tip_mm.z())}, milling_.travel_mm_s);
      is_lifted_ = false;
    }
    milled_mm_ += (tip_mm - last_mm_).norm();
    add(tip_mm, milling_.feed_mm_s);
  }

  void lift() {
    if (knots_.empty() || is_lifted_) return;
    add({last_mm_.x(), last_mm_.y(), highest_mm_ - milling_.lift_mm}, milling_.travel_mm_s);
    is_lifted_ = true;
  }

  void begin(const Vec3& tip_mm) {
    knots_.push_back({0.0, frame_.to_patient(tip_mm)});
    last_mm_ = tip_mm;
    is_lifted_ = true;
  }
  void add(const Vec3& tip_mm, double mm_s) {
    const double way_mm = (tip_mm - last_mm_).norm();
    if (!(way_mm > 0.0)) return;
    knots_.push_back({knots_.back().time_s + way_mm / mm_s, frame_.to_patient(tip_mm)});
    last_mm_ = tip_mm;
  }

  const Milling& milling_;
  PathFrame frame_;
  Eigen::Vector2d along_;
  std::vector<MilledLine> lines_;
  double highest_mm_ = std::numeric_limits<double>::infinity();  ///< bone of the patch: its least z
  std::vector<MillingMotion::Knot> knots_;
  Vec3 last_mm_ = Vec3::Zero();
  bool is_lifted_ = false;
  double milled_mm_ = 0.0;
};

}  // namespace

void check_milling(const Milling& milling, const DrillBit& bit) {
  check_bit(bit);
  check_turns(bit, "a milling");
  if (milling.outline_mm.size() < 3) fail("milling: expected 3 corners or more, found ", milling.outline_mm.size());
  if (milling.outline_mm.size() > 10'000) fail("milling: expected at most 10000 corners");
  for (const Vec3& corner : milling.outline_mm) {
    if (!corner.allFinite() || corner.cwiseAbs().maxCoeff() > 1e4) fail("milling: expected corners within 10 m");
    if ((corner - milling.outline_mm.front()).norm() > 300.0) {
      fail("milling: expected a patch of at most 300 mm, found corners further apart");
    }
  }
  if (!(std::abs(milling.into.norm() - 1.0) < 1e-6)) fail("milling: expected a direction \"into\" of length 1");
  const double width_mm = 2.0 * bit.radius_mm();
  const bool follows = milling.depth == Milling::Depth::below_surface;
  check_milled_range(milling.depth_mm, follows ? 0.01 : -kMilledReachMm, kMilledReachMm, "a depth");
  if (!(milling.layer_mm >= 0.01 && milling.layer_mm <= width_mm)) {
    fail("milling: expected layers of 0.01 mm up to the tool's width of ", width_mm, " mm, found ", milling.layer_mm);
  }
  if (!(milling.apart_mm >= 0.05 && milling.apart_mm <= width_mm)) {
    fail("milling: expected lines apart by 0.05 mm up to the tool's width of ", width_mm, " mm, found ",
         milling.apart_mm);
  }
  for (const double mm_s : {milling.feed_mm_s, milling.travel_mm_s}) {
    if (!(mm_s >= 0.01 && mm_s <= 1000.0)) fail("milling: expected feeds from 0.01 to 1000 mm/s, found ", mm_s);
  }
  check_milled_range(milling.lift_mm, 0.1, 100.0, "a lift");
}

MillingMotion::MillingMotion(const Milling& milling, const DrillBit& bit, const ScalarField& bone,
                             const MillingMotionOptions& options)
    : tremor_(options.tremor_mm, options.seed), trembles_(options.tremor_mm > 0.0), rate_hz_(options.rate_hz) {
  check_milling(milling, bit);
  if (!(rate_hz_ > 0.0 && rate_hz_ <= 1e6)) fail("milling: expected a rate above 0, up to 1e6 Hz, found ", rate_hz_);
  MillingPlanner planner(milling, bone);
  frame_ = planner.frame();
  knots_ = planner.knots(length_mm_);
  const double poses = std::ceil(knots_.back().time_s * rate_hz_ - 1e-9) + 1.0;
  if (poses > 0x1p27) fail("milling: expected at most 2^27 poses, found ", poses, ": lessen the rate");
  poses_ = static_cast<std::size_t>(poses);
}

Pose MillingMotion::pose(std::size_t index) const {
  const double time_s = std::min(static_cast<double>(index) / rate_hz_, knots_.back().time_s);
  const auto after = std::lower_bound(knots_.begin() + 1, knots_.end() - 1, time_s,
                                      [](const Knot& knot, double time) { return knot.time_s < time; });
  const Knot& a = *(after - 1);
  const double share = std::clamp((time_s - a.time_s) / (after->time_s - a.time_s), 0.0, 1.0);
  Pose pose = frame_.to_patient(Pose{Vec3::Zero(), Vec3::UnitZ()});
  pose.tip_mm = a.tip_mm + share * (after->tip_mm - a.tip_mm);
  if (trembles_) pose.tip_mm += frame_.to_patient(tremor_.at_mm(time_s)) - frame_.to_patient(Vec3(Vec3::Zero()));
  return pose;
}

std::optional<ToolInput> MillingMotion::next(const ToolFeedback& feedback) {
  if (feedback.stop || index_ == poses_) return std::nullopt;
  return ToolInput{pose(index_++), true, 1.0 / rate_hz_};
}

}  // namespace spinaltap

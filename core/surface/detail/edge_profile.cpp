#include "core/surface/detail/edge_profile.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/lerp.h"

namespace spinaltap {
namespace {

constexpr double kLowestContrastHu = 100.0;
constexpr double kMinAboveHu = 50.0;  // of the cortex over the tissue outside

/// The standard normal distribution and its density, from a table: cubic interpolation by the known slopes, good to
/// 1e-8.
class NormalTable {
 public:
  struct Value {
    double cdf, pdf;
  };

  NormalTable() {
    for (int i = 0; i <= kCells; ++i) {
      const double z = -kReach + i * kStep;
      cells_[static_cast<std::size_t>(i)] = {
          0.5 * std::erfc(-z / std::numbers::sqrt2),
          std::exp(-0.5 * z * z) * 0.5 * std::numbers::inv_sqrtpi * std::numbers::sqrt2};
    }
  }

  Value at(double z) const {
    if (!(z > -kReach)) return {0.0, 0.0};
    if (!(z < kReach)) return {1.0, 0.0};
    const double place = (z + kReach) / kStep;
    const auto cell = static_cast<std::size_t>(place);
    const double t = place - static_cast<double>(cell);
    const Value& low = cells_[cell];
    const Value& high = cells_[cell + 1];
    const double at_low = z - t * kStep;
    return {hermite(t, low.cdf, high.cdf, kStep * low.pdf, kStep * high.pdf),
            hermite(t, low.pdf, high.pdf, -kStep * at_low * low.pdf, -kStep * (at_low + kStep) * high.pdf)};
  }

 private:
  static constexpr double kReach = 6.0;
  static constexpr int kCells = 512;
  static constexpr double kStep = 2.0 * kReach / kCells;

  static double hermite(double t, double low, double high, double low_slope, double high_slope) {
    const double u = 1.0 - t;
    return u * u * ((1.0 + 2.0 * t) * low + t * low_slope) + t * t * ((1.0 + 2.0 * u) * high - u * high_slope);
  }

  std::array<Value, kCells + 2> cells_{};
};

const NormalTable& normal_table() {
  static const NormalTable table;
  return table;
}

/// Samples of a profile from the cancellous bone behind the cortex's peak to the lowest place outside it.
struct ProfileWindow {
  int begin = 0, peak = 0, end = 0;
};

std::optional<ProfileWindow> find_window(const EdgeProfile& profile, double blur_mm, double reach_mm) {
  constexpr double kRiseHu = 60.0;  // beyond the lowest place: the next bone
  const int reach = std::min(static_cast<int>(std::ceil(reach_mm / profile.step_mm)), EdgeProfile::kOutside - 2);
  const auto hu = [&](int i) { return profile.hu[static_cast<std::size_t>(i)]; };
  ProfileWindow window;
  window.peak = EdgeProfile::kInside - reach;
  for (int i = window.peak; i <= EdgeProfile::kInside + reach * 2 / 3; ++i) {
    if (hu(i) > hu(window.peak)) window.peak = i;
  }
  int lowest = window.peak;
  for (int i = window.peak; i < EdgeProfile::kCount; ++i) {
    if (hu(i) < hu(lowest)) lowest = i;
    if (hu(i) > hu(lowest) + kRiseHu) break;
  }
  if (hu(window.peak) - hu(lowest) < kLowestContrastHu) return std::nullopt;
  window.begin = std::max(0, window.peak - static_cast<int>(2.0 * blur_mm / profile.step_mm) - 6);
  window.end = lowest + 1;
  return window;
}

/// Places along a window and the parts of a blurred edge there.
class WindowedProfile {
 public:
  WindowedProfile(const EdgeProfile& profile, const ProfileWindow& window, double blur_mm)
      : profile_(profile), window_(window), blur_mm_(blur_mm) {}

  int begin() const { return window_.begin; }
  int end() const { return window_.end; }
  double hu(int i) const { return profile_.hu[static_cast<std::size_t>(i)]; }
  /// How far sample i lies beyond `edge_mm`, in standard deviations of the blur.
  double beyond(int i, double edge_mm) const { return (profile_.way_mm(i) - edge_mm) / blur_mm_; }
  double blur_mm() const { return blur_mm_; }
  double bound_way(double way_mm) const {
    return std::clamp(way_mm, profile_.way_mm(window_.begin), profile_.way_mm(window_.end));
  }
  double peak_way_mm() const { return profile_.way_mm(window_.peak); }
  double peak_hu() const { return hu(window_.peak); }

  /// Where the profile falls to halfway between the peak and the outside.
  double half_maximum_mm() const {
    const double level_hu = 0.5 * (peak_hu() + hu(window_.end - 1));
    int at = window_.peak;
    while (hu(at) > level_hu) ++at;
    return profile_.way_mm(at) - profile_.step_mm * (level_hu - hu(at)) / (hu(at - 1) - hu(at));
  }

 private:
  const EdgeProfile& profile_;
  const ProfileWindow& window_;
  double blur_mm_;
};

constexpr double kLowestHu = -1100.0;

/// Cancellous bone, cortex of known density, tissue outside: offset, thickness, inside, outside.
class CortexEdge {
 public:
  using Vector = Eigen::Vector4d;
  using Matrix = Eigen::Matrix4d;

  CortexEdge(const WindowedProfile& profile, double blur_mm, double cortex_hu)
      : profile_(profile), blur_mm_(blur_mm), cortex_hu_(cortex_hu) {}

  Vector start() const {
    const double half_mm = profile_.half_maximum_mm();
    return {half_mm - 0.2 * blur_mm_, std::clamp(half_mm - profile_.peak_way_mm(), 0.3, 2.0),
            profile_.hu(profile_.begin()), profile_.hu(profile_.end() - 1)};
  }

  Vector bound(const Vector& q) const {
    constexpr double kThinnestMm = 0.25, kThickestMm = 5.0;  // a vertebra's shell is hardly thinner
    return {profile_.bound_way(q[0]), std::clamp(q[1], kThinnestMm, kThickestMm),
            std::clamp(q[2], kLowestHu, cortex_hu_), std::clamp(q[3], kLowestHu, cortex_hu_ - kMinAboveHu)};
  }

  /// What the model leaves of sample i, and the model's slope by its numbers.
  double miss(const Vector& q, int i, Vector& slope) const {
    const NormalTable::Value inner = normal_.at(profile_.beyond(i, q[0] - q[1]));
    const NormalTable::Value outer = normal_.at(profile_.beyond(i, q[0]));
    const double by_inner = (cortex_hu_ - q[2]) * inner.pdf / blur_mm_;
    const double by_outer = (cortex_hu_ - q[3]) * outer.pdf / blur_mm_;
    slope = Vector(by_outer - by_inner, by_inner, 1.0 - inner.cdf, outer.cdf);
    return profile_.hu(i) - (q[2] + (cortex_hu_ - q[2]) * inner.cdf - (cortex_hu_ - q[3]) * outer.cdf);
  }

 private:
  const WindowedProfile& profile_;
  double blur_mm_, cortex_hu_;
  const NormalTable& normal_ = normal_table();
};

/// Bone as dense inside as at its edge: offset, inside, outside.
class PlainEdge {
 public:
  using Vector = Eigen::Vector3d;
  using Matrix = Eigen::Matrix3d;

  explicit PlainEdge(const WindowedProfile& profile) : profile_(profile) {}

  Vector start() const {
    return {profile_.half_maximum_mm(), profile_.hu(profile_.begin()), profile_.hu(profile_.end() - 1)};
  }
  Vector bound(const Vector& q) const { return {profile_.bound_way(q[0]), q[1], q[2]}; }
  double miss(const Vector& q, int i, Vector& slope) const {
    const NormalTable::Value outer = normal_.at(profile_.beyond(i, q[0]));
    slope = Vector((q[1] - q[2]) * outer.pdf / profile_.blur_mm(), 1.0 - outer.cdf, outer.cdf);
    return profile_.hu(i) - lerp(q[1], q[2], outer.cdf);
  }

 private:
  const WindowedProfile& profile_;
  const NormalTable& normal_ = normal_table();
};

template <class Edge>
struct Solution {
  typename Edge::Vector q;
  double rms_hu = 0.0;
};

/// Damped least squares (Levenberg and Marquardt).
template <class Edge>
Solution<Edge> solve(const Edge& edge, const WindowedProfile& profile) {
  constexpr int kMaxSteps = 25;
  constexpr double kDone = 1e-4;  // relative gain of a step
  constexpr double kMaxDamping = 1e6;
  using Vector = typename Edge::Vector;
  struct Normal {
    typename Edge::Matrix matrix = Edge::Matrix::Zero();  // its lower triangle, which is what is solved
    Vector right_side = Vector::Zero();
    double squares = 0.0;
  };
  const auto linearise = [&](const Vector& q) {
    Normal normal_equations;
    Vector slope;
    for (int i = profile.begin(); i < profile.end(); ++i) {
      const double miss = edge.miss(q, i, slope);
      for (Eigen::Index column = 0; column < slope.size(); ++column) {
        for (Eigen::Index row = column; row < slope.size(); ++row) {
          normal_equations.matrix(row, column) += slope[row] * slope[column];
        }
      }
      normal_equations.right_side += slope * miss;
      normal_equations.squares += miss * miss;
    }
    return normal_equations;
  };
  Vector best = edge.bound(edge.start());
  Normal at_best = linearise(best);
  double damping = 1e-3;
  for (int step = 0; step < kMaxSteps && damping < kMaxDamping; ++step) {
    typename Edge::Matrix damped = at_best.matrix;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-6;  // a thick cortex hides the cancellous bone
    const Vector next = edge.bound(best + damped.ldlt().solve(at_best.right_side));
    const Normal at_next = linearise(next);
    if (!(at_next.squares < at_best.squares)) {
      damping *= 8.0;
      continue;
    }
    const bool done = at_best.squares - at_next.squares < kDone * at_best.squares;
    best = next;
    at_best = at_next;
    if (done) break;
    damping = std::max(1e-6, 0.3 * damping);
  }
  return {best, std::sqrt(at_best.squares / (profile.end() - profile.begin()))};
}

}  // namespace

double EdgeModel::blur_mm(const Vec3& direction, const GridGeometry& geometry) const {
  const double across = direction.dot(geometry.directions.col(2));
  return std::sqrt(blur_in_slice_mm * blur_in_slice_mm * (1.0 - across * across) +
                   blur_across_mm * blur_across_mm * across * across);
}

EdgeProfile sample_profile(const FloatGrid& hu, const Vec3& p_mm, const Vec3& normal, double step_mm) {
  EdgeProfile profile;
  profile.step_mm = step_mm;
  profile.normal = normal;
  for (int i = 0; i < EdgeProfile::kCount; ++i) {
    profile.hu[static_cast<std::size_t>(i)] =
        sample_clamped(hu, hu.geometry.to_index(p_mm + profile.way_mm(i) * normal));
  }
  return profile;
}

std::optional<EdgeFit> fit_edge(const EdgeProfile& profile, const EdgeModel& model, const GridGeometry& geometry,
                                double reach_mm) {
  constexpr double kWorstShare = 0.25;  // of the contrast that the model may leave
  // There is no cortex to be seen where it does not stand out of what is behind it and an edge without one leaves
  // hardly more, or next to nothing of the contrast.
  constexpr double kStandsOut = 0.3;
  constexpr double kHardlyMore = 1.3;
  constexpr double kNextToNothing = 0.015;
  const double blur_mm = model.blur_mm(profile.normal, geometry);
  const std::optional<ProfileWindow> window = find_window(profile, blur_mm, reach_mm);
  if (!window) return std::nullopt;
  const WindowedProfile windowed(profile, *window, blur_mm);
  const Solution<CortexEdge> cortex = solve(CortexEdge(windowed, blur_mm, model.cortex_hu), windowed);
  EdgeFit fit{cortex.q[0], cortex.q[1], cortex.q[2], cortex.q[3], cortex.rms_hu};
  const double contrast_hu = windowed.peak_hu() - fit.outside_hu;
  if (windowed.peak_hu() - windowed.hu(windowed.begin()) < kStandsOut * contrast_hu) {
    const Solution<PlainEdge> plain = solve(PlainEdge(windowed), windowed);
    if (plain.rms_hu <= std::max(kHardlyMore * cortex.rms_hu, kNextToNothing * contrast_hu)) {
      fit = {plain.q[0], 0.0, plain.q[1], plain.q[2], plain.rms_hu};
    }
  }
  if (!(fit.rms_hu <= kWorstShare * contrast_hu)) return std::nullopt;
  if (!(std::abs(fit.offset_mm) <= reach_mm)) return std::nullopt;
  return fit;
}

}  // namespace spinaltap

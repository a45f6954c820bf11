#pragma once

#include <array>
#include <numbers>

#include "core/phantom/detail/shapes.h"
#include "core/phantom/vertebra_anatomy.h"

/// The parts of a vertebra that are not plain bars or plates. Rules as in shapes.h.
namespace spinaltap::shapes {

inline double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// Largest slope of t*t/(t*t + w*w), and of (1 - t*t)^2 on [0, 1].
inline constexpr double kSaturationSlope = 0.6495190528383290;
inline constexpr double kBumpSlope = 1.5396007178390020;

/// (1 - s)^2 where s, a square, is below 1; 0 beyond.
template <class T>
T bump(const T& s) {
  if (value_of(s) >= 1.0) return s * 0.0;
  const T rest = 1.0 - s;
  return rest * rest;
}

/// The vertebral body: an elliptic column with a waist, whose back corners are drawn backward (a kidney), between two
/// hollow endplates.
class BodyShape {
 public:
  BodyShape() = default;
  explicit BodyShape(const VertebraAnatomy::Body& body)
      : body_(body),
        flatness_(body.depth_mm / body.width_mm),
        half_depth_(0.5 * body.depth_mm),
        half_height_(0.5 * body.height_mm),
        rim_z_(half_height_ - body.edge_mm),
        rim_radius_(half_depth_ - body.rim_mm) {
    // Norm of the map (x, y) -> (flatness * x, y - shift(x)): its slopes are at most `flatness` and `shear`.
    const double shear = body.kidney_mm * kSaturationSlope / body.kidney_width_mm;
    const double a = flatness_ * flatness_ + shear * shear, b = shear, c = 1.0;
    const double norm2 = 0.5 * (a + c) + std::sqrt(0.25 * (a - c) * (a - c) + b * b);
    const double waist_slope = body.waist_mm * kBumpSlope / rim_z_;
    wall_scale_ = 1.0 / std::sqrt(norm2 + waist_slope * waist_slope);
    const double hollow = std::max(body.superior_hollow_mm, body.inferior_hollow_mm);
    const double hollow_slope = hollow * kBumpSlope / rim_radius_;
    // Each endplate has half of either wedge.
    slope_y_ = std::tan(0.5 * radians(body.wedge_deg));
    slope_x_ = -std::tan(0.5 * radians(body.side_wedge_deg));
    const double tilt = std::hypot(slope_x_, slope_y_);
    const double both = hollow_slope * hollow_slope * norm2 + tilt * (2.0 * hollow_slope * std::sqrt(norm2) + tilt);
    end_scale_ = 1.0 / std::sqrt(1.0 + both);
  }

  template <class T>
  T operator()(const Point<T>& p) const {
    const T x2 = p.x * p.x;
    const T shift = x2 * body_.kidney_mm / (x2 + body_.kidney_width_mm * body_.kidney_width_mm);
    const T backward = 0.5 + 0.5 * (p.y / root(p.y * p.y + kTurn * kTurn));
    const T y = p.y - shift * backward;
    const T r2 = x2 * (flatness_ * flatness_) + y * y;
    const T wall_radius = half_depth_ - body_.waist_mm * bump(p.z * p.z * (1.0 / (rim_z_ * rim_z_)));
    const T wall = (root(r2) - wall_radius) * wall_scale_;
    const T hollow = bump(r2 * (1.0 / (rim_radius_ * rim_radius_)));
    const T tilt = p.x * slope_x_ + p.y * slope_y_;
    const T top = p.z - half_height_ + hollow * body_.superior_hollow_mm - tilt;
    const T bottom = -p.z - half_height_ + hollow * body_.inferior_hollow_mm - tilt;
    const T end = (value_of(top) > value_of(bottom) ? top : bottom) * end_scale_;
    return smooth_max(wall, end, body_.edge_mm);
  }

  Box3 bounds() const {
    const double half_width = 0.5 * body_.width_mm, half_y = half_depth_ + body_.kidney_mm;
    const double rise = std::fabs(slope_x_) * half_width + std::fabs(slope_y_) * half_y;
    const Vec3 half(half_width, half_y, half_height_ + rise);
    return Box3(-half, half);
  }

 private:
  static constexpr double kTurn = 8.0;  ///< mm over which the kidney's shift sets in behind the middle

  VertebraAnatomy::Body body_;
  double flatness_ = 1.0, half_depth_ = 1.0, half_height_ = 1.0, rim_z_ = 1.0, rim_radius_ = 1.0;
  double wall_scale_ = 1.0, end_scale_ = 1.0, slope_x_ = 0.0, slope_y_ = 0.0;
};

/// A pedicle: an elliptic section of one aspect ratio, narrowest at the isthmus and flaring to both ends.
class PedicleShape {
 public:
  PedicleShape() = default;
  explicit PedicleShape(const VertebraAnatomy::Pedicle& pedicle) : pedicle_(pedicle) {
    const double convergence = radians(pedicle.convergence_deg), tilt = radians(pedicle.tilt_deg);
    forward_ = Vec3(-std::sin(convergence) * std::cos(tilt), -std::cos(convergence) * std::cos(tilt), std::sin(tilt));
    sideways_ = Vec3(std::cos(convergence), -std::sin(convergence), 0.0);
    upward_ = forward_.cross(sideways_);
    flatness_ = pedicle.width_mm / pedicle.height_mm;
    const double slope = pedicle.flare_mm * kSaturationSlope / pedicle.flare_length_mm;
    scale_ = 1.0 / std::sqrt(1.0 + slope * slope);
  }

  template <class T>
  T operator()(const Point<T>& p) const {
    const Point<T> q = minus(p, pedicle_.isthmus_mm);
    const T u = dot(sideways_, q);
    const T v = dot(upward_, q) * flatness_;
    const T t = dot(forward_, q);
    const T t2 = t * t;
    const T flare = t2 * pedicle_.flare_mm / (t2 + pedicle_.flare_length_mm * pedicle_.flare_length_mm);
    const T wall = (root(u * u + v * v) - (0.5 * pedicle_.width_mm + flare)) * scale_;
    const T end = value_of(t) > 0.0 ? t - pedicle_.anterior_length_mm : -t - pedicle_.posterior_length_mm;
    return smooth_max(wall, end, kEndRounding);
  }

  const Vec3& forward() const { return forward_; }
  const Vec3& sideways() const { return sideways_; }
  const Vec3& upward() const { return upward_; }

  Box3 bounds() const {
    const double radius = 0.5 * pedicle_.width_mm + pedicle_.flare_mm;
    Box3 box;
    for (const double t : {pedicle_.anterior_length_mm, -pedicle_.posterior_length_mm}) {
      const Vec3 centre = pedicle_.isthmus_mm + t * forward_;
      const Vec3 half = radius * sideways_.cwiseAbs() + radius / flatness_ * upward_.cwiseAbs();
      box.extend(centre - half).extend(centre + half);
    }
    return box;
  }

 private:
  static constexpr double kEndRounding = 3.0;

  VertebraAnatomy::Pedicle pedicle_;
  Vec3 forward_ = Vec3::UnitX(), sideways_ = Vec3::UnitY(), upward_ = Vec3::UnitZ();
  double flatness_ = 1.0, scale_ = 1.0;
};

/// The hollow of the vertebral canal: a rounded triangle, endless along z.
class CanalShape {
 public:
  CanalShape() = default;
  explicit CanalShape(const VertebraAnatomy::Canal& canal)
      : canal_(canal), sine_(std::sin(radians(canal.roof_deg))), cosine_(std::cos(radians(canal.roof_deg))) {}

  template <class T>
  T operator()(const Point<T>& p) const {
    const T x = soft_magnitude(p.x, kRidge);
    const T front = canal_.front_mm - p.y;
    const T side = x - 0.5 * canal_.width_mm;
    const T roof = x * sine_ + (p.y - canal_.back_mm) * cosine_ - kRidge * sine_;
    return smooth_max(smooth_max(front, side, canal_.rounding_mm), roof, canal_.rounding_mm);
  }

 private:
  static constexpr double kRidge = 2.5;  ///< rounding of the roof's ridge

  VertebraAnatomy::Canal canal_;
  double sine_ = 0.0, cosine_ = 1.0;
};

/// The spinous process: a convex plate in the midplane, thicker towards its tip.
class SpinousShape {
 public:
  SpinousShape() = default;
  explicit SpinousShape(const VertebraAnatomy::Spinous& spinous) : spinous_(spinous) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner : spinous.outline_mm) middle += corner / static_cast<double>(kSides);
    for (std::size_t side = 0; side < kSides; ++side) {
      const Eigen::Vector2d& a = spinous.outline_mm[side];
      const Eigen::Vector2d edge = spinous.outline_mm[(side + 1) % kSides] - a;
      Eigen::Vector2d normal = Eigen::Vector2d(edge.y(), -edge.x()).normalized();
      if (normal.dot(middle - a) > 0.0) normal = -normal;
      normals_[side] = normal;
      offsets_[side] = normal.dot(a);
      root_y_ = std::min(root_y_, a.x());
      tip_y_ = std::max(tip_y_, a.x());
    }
    slope_ = 0.5 * (spinous.tip_thickness_mm - spinous.root_thickness_mm) / (tip_y_ - root_y_);
    scale_ = 1.0 / std::sqrt(1.0 + slope_ * slope_);
  }

  template <class T>
  T operator()(const Point<T>& p) const {
    T outline = p.y * normals_[0].x() + p.z * normals_[0].y() - offsets_[0];
    for (std::size_t side = 1; side < kSides; ++side) {
      const T edge = p.y * normals_[side].x() + p.z * normals_[side].y() - offsets_[side];
      outline = smooth_max(outline, edge, spinous_.rounding_mm);
    }
    const T along = p.y - root_y_;
    const T inner = along - beyond(along, 0.0, tip_y_ - root_y_);
    const T half = 0.5 * spinous_.root_thickness_mm + slope_ * inner;
    return smooth_max(outline, (magnitude(p.x) - half) * scale_, kEdge);
  }

  Box3 bounds() const {
    const double half = 0.5 * std::max(spinous_.root_thickness_mm, spinous_.tip_thickness_mm);
    Box3 box;
    for (const Eigen::Vector2d& corner : spinous_.outline_mm) {
      box.extend(Vec3(-half, corner.x(), corner.y())).extend(Vec3(half, corner.x(), corner.y()));
    }
    return box;
  }

 private:
  static constexpr std::size_t kSides = 5;
  static constexpr double kEdge = 4.0;  ///< rounding of the plate's edges

  VertebraAnatomy::Spinous spinous_;
  std::array<Eigen::Vector2d, kSides> normals_;
  std::array<double, kSides> offsets_{};
  double root_y_ = 1e9, tip_y_ = -1e9, slope_ = 0.0, scale_ = 1.0;
};

/// The superior articular process: a bar with a facet, the hollow of a cylinder, on its inner back side.
class SuperiorArticularShape {
 public:
  SuperiorArticularShape() = default;
  SuperiorArticularShape(const VertebraAnatomy::Process& process, const VertebraAnatomy::Facet& facet)
      : bar_(process.root_mm, process.tip_mm, process.thin_direction, process.root_thickness_mm,
             process.tip_thickness_mm, process.width_over_thickness),
        radius_(facet.radius_mm) {
    const Frame frame = make_frame(process.tip_mm - process.root_mm, process.thin_direction);
    axis_ = frame.axis;
    centre_ = process.tip_mm + (0.5 * process.tip_thickness_mm - facet.hollow_mm + facet.radius_mm) * frame.thin;
  }

  template <class T>
  T operator()(const Point<T>& p) const {
    const Point<T> q = minus(p, centre_);
    const T along = dot(axis_, q);
    const T across = root(q.x * q.x + q.y * q.y + q.z * q.z - along * along);
    return smooth_max(bar_(p), radius_ - across, kRim);
  }

  Box3 bounds() const { return bar_.bounds(); }

 private:
  static constexpr double kRim = 1.2;  ///< rounding of the facet's rim

  FlatBar bar_;
  Vec3 centre_ = Vec3::Zero(), axis_ = Vec3::UnitZ();
  double radius_ = 1.0;
};

/// A ball.
class BallShape {
 public:
  BallShape() = default;
  BallShape(const Vec3& centre, double radius) : centre_(centre), radius_(radius) {}

  template <class T>
  T operator()(const Point<T>& p) const {
    const Point<T> q = minus(p, centre_);
    return root(q.x * q.x + q.y * q.y + q.z * q.z) - radius_;
  }

  Box3 bounds() const { return Box3(centre_.array() - radius_, centre_.array() + radius_); }

 private:
  Vec3 centre_ = Vec3::Zero();
  double radius_ = 1.0;
};

}  // namespace spinaltap::shapes

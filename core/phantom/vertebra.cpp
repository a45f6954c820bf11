#include "core/phantom/vertebra.h"

#include <cmath>

#include "core/base/error.h"
#include "core/phantom/texture.h"
#include "core/phantom/vertebra_shape.h"

namespace spinaltap {
namespace {

using shapes::Point;
using shapes::smooth_step;

/// Values up to a band's start are made distances; from its end they are the shape's own. Inside the bone the band is
/// narrower, as thin processes have their middle there.
struct Band {
  double start, end;
};
constexpr Band kOutsideBand{0.5, 1.6}, kInsideBand{0.35, 1.05};

/// Distances are lessened by this share a mm, which takes back what Newton's method overshoots.
constexpr double kCaution = 0.04;

/// No part is flatter than kSteep at the surface. Below kFlat, where parts face each other, no distance is worked out.
constexpr double kFlat = 0.2, kSteep = 0.4;

Mat3 rotation_from_degrees(const Vec3& degrees) {
  const auto turn = [&](int axis) {
    return Eigen::AngleAxisd(shapes::radians(degrees[axis]), Vec3::Unit(axis)).toRotationMatrix();
  };
  return turn(2) * turn(1) * turn(0);
}

Dual value_and_slope(const shapes::VertebraShape& shape, const Vec3& p) {
  return shape(Point<Dual>{{p.x(), 1.0, 0.0, 0.0}, {p.y(), 0.0, 1.0, 0.0}, {p.z(), 0.0, 0.0, 1.0}});
}

/// A plane that touches the shape's surface, to first order, below a point: unit normal and the point's height above.
struct Tangent {
  Vec3 normal;
  double height;
  double slope;  ///< of the shape at the foot point, mm per mm
};

Tangent tangent_at(const shapes::VertebraShape& shape, const Vec3& foot, const Vec3& p) {
  const Dual f = value_and_slope(shape, foot);
  const Vec3 gradient(f.dx, f.dy, f.dz);
  const double slope = gradient.norm();
  const double divisor = std::max(slope, 0.5 * kFlat);
  const Vec3 normal = gradient / divisor;
  return {normal, (p - foot).dot(normal) + f.v / divisor, slope};
}

const VertebraAnatomy::Pedicle& right_pedicle(const VertebraAnatomy& anatomy) {
  return anatomy.right_pedicle ? *anatomy.right_pedicle : anatomy.pedicle;
}

/// The isthmus is exact when every point of its ellipse is a zero of the whole shape. `side`: 1 for left, -1 for right.
void check_isthmus(const shapes::VertebraShape& whole, const VertebraAnatomy::Pedicle& pedicle,
                   const shapes::PedicleShape& shape, double side) {
  for (int step = 0; step < 90; ++step) {
    const double angle = shapes::radians(4.0 * step);
    const Vec3 p = pedicle.isthmus_mm + 0.5 * pedicle.width_mm * std::cos(angle) * shape.sideways() +
                   0.5 * pedicle.height_mm * std::sin(angle) * shape.upward();
    const double value = whole(Point<double>{side * p.x(), p.y(), p.z()});
    if (!(std::fabs(value) < 1e-9)) {
      fail("vertebra: the ", side > 0.0 ? "left" : "right",
           " pedicle's isthmus must be free of fillets and canal, but ", std::fabs(value), " mm are added at (",
           side * p.x(), ", ", p.y(), ", ", p.z(), "); move it or make blend_mm smaller");
    }
  }
}

}  // namespace

struct Vertebra::Inside {
  shapes::VertebraShape shape;
  Texture texture;
};

Vertebra::Vertebra(const VertebraAnatomy& anatomy) : anatomy_(anatomy) {
  check_anatomy(anatomy);
  rotation_ = rotation_from_degrees(anatomy.placement.rotation_deg);
  const VertebraAnatomy::Cancellous& bone = anatomy.cancellous;
  const Vec3 grain = bone.texture_scale_mm * Vec3(1.0, 1.0, bone.texture_stretch);
  inside_ = std::make_unique<const Inside>(Inside{shapes::VertebraShape(anatomy), Texture(grain, bone.texture_seed)});
  check_isthmus(inside_->shape, anatomy.pedicle, inside_->shape.left_pedicle(), 1.0);
  check_isthmus(inside_->shape, right_pedicle(anatomy), inside_->shape.right_pedicle(), -1.0);
}

Vertebra::~Vertebra() = default;

/// The shape's value f lies between 0 and the distance D, as it grows by at most 1 mm per mm. Near the surface D comes
/// from the tangent plane at the foot point, found by two steps of Newton's method; further away D fades into f, which
/// keeps the bound, as it only lessens the growth.
double Vertebra::value_mm(const Vec3& p) const {
  const double f = inside_->shape(Point<double>{p.x(), p.y(), p.z()});
  const Band& band = f < 0.0 ? kInsideBand : kOutsideBand;
  double weight = 1.0 - smooth_step(band.start, band.end, std::fabs(f));
  if (weight <= 0.0) return f;
  const Tangent first = tangent_at(inside_->shape, p, p);
  weight *= smooth_step(kFlat, kSteep, first.slope);
  if (weight <= 0.0) return f;
  const Tangent second = tangent_at(inside_->shape, p - first.height * first.normal, p);
  constexpr double kMostGrowth = 1.0 / kSteep;
  const double cautious = second.height / (1.0 + kCaution * std::fabs(second.height));
  const double distance = std::clamp(cautious, std::min(f, kMostGrowth * f), std::max(f, kMostGrowth * f));
  return f + weight * (distance - f);
}

void Vertebra::evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3> gradients) const {
  constexpr double kStep = 1e-5;
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    const Vec3 p = to_own(points_mm[n]);
    values_mm[n] = value_mm(p);
    if (gradients.empty()) continue;
    Vec3 slope;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = kStep * Vec3::Unit(axis);
      slope[axis] = (value_mm(p + step) - value_mm(p - step)) / (2.0 * kStep);
    }
    gradients[n] = rotation_ * slope;
  }
}

Box3 Vertebra::bounds_mm() const {
  Box3 box;
  for (int corner = 0; corner < 8; ++corner) {
    box.extend(to_patient(inside_->shape.bounds().corner(static_cast<Box3::CornerType>(corner))));
  }
  return box;
}

double Vertebra::hu(const Vec3& p_patient, double distance_mm, double aperture_mm) const {
  // Regions go over into each other within this many mm on both sides of their border.
  constexpr double kBorder = 2.5;
  const Vec3 p = to_own(p_patient);
  const VertebraAnatomy::Cortex& cortex = anatomy_.cortex;
  const VertebraAnatomy::Cancellous& bone = anatomy_.cancellous;
  const double half_depth = 0.5 * anatomy_.body.depth_mm, half_height = 0.5 * anatomy_.body.height_mm;
  // Where the sides differ, they part in the canal, at x = 0.
  const VertebraAnatomy::Pedicle& nearer = p.x() < 0.0 ? right_pedicle(anatomy_) : anatomy_.pedicle;
  const double arch_y = nearer.isthmus_mm.y() + 0.6 * nearer.posterior_length_mm;
  const double behind_body = smooth_step(half_depth - 1.5 - kBorder, half_depth - 1.5 + kBorder, p.y());
  const double in_arch = smooth_step(arch_y - kBorder, arch_y + kBorder, p.y());
  const auto blend = [&](double body, double pedicle, double arch) {
    return std::lerp(std::lerp(body, pedicle, behind_body), arch, in_arch);
  };
  const double hollow = std::max(anatomy_.body.superior_hollow_mm, anatomy_.body.inferior_hollow_mm);
  const double at_endplate = smooth_step(half_height - hollow - 3.0, half_height - hollow - 1.0, std::fabs(p.z()));
  const double wall = std::lerp(cortex.body_wall_mm, cortex.endplate_mm, at_endplate);
  const double shell = blend(wall, cortex.pedicle_mm, cortex.posterior_mm);
  const double depth = -distance_mm;
  const double cortical =
      aperture_mm > 0.0 ? std::clamp((shell - depth) / aperture_mm + 0.5, 0.0, 1.0) : (depth < shell ? 1.0 : 0.0);
  if (cortical >= 1.0) return cortex.hu;
  const double core =
      blend(bone.body_hu, bone.pedicle_hu, bone.posterior_hu) + bone.texture_hu * inside_->texture.at(p);
  return std::lerp(core, cortex.hu, cortical);
}

}  // namespace spinaltap

#include "core/phantom/vertebra.h"

#include <cmath>

#include "core/base/error.h"
#include "core/phantom/detail/shape_solid.h"
#include "core/phantom/detail/texture.h"
#include "core/phantom/detail/vertebra_shape.h"

namespace spinaltap {
namespace {

using shapes::Point;
using shapes::smooth_step;

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

double Vertebra::value_mm(const Vec3& p) const { return shapes::near_distance_mm(inside_->shape, p); }

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

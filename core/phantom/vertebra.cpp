#include "core/phantom/vertebra.h"

#include <cmath>
#include <optional>

#include "core/base/error.h"
#include "core/base/lerp.h"
#include "core/phantom/detail/shape_solid.h"
#include "core/phantom/detail/texture.h"
#include "core/phantom/detail/vertebra_parts.h"

namespace spinaltap::shapes {
namespace {

/// A shape, the ball that holds it with room to spare, and the reach of its fillet. The part's value is the larger
/// one of the shape's and the ball's, so that leaving the shape out where its ball is far changes nothing.
template <class Shape>
struct Part {
  Shape shape;
  Vec3 centre = Vec3::Zero();
  double radius = 0.0;
  double reach = 0.0;
};

/// The whole vertebra in its own frame: parts joined by smooth minima, less the canal.
class VertebraShape {
 public:
  VertebraShape() = default;
  explicit VertebraShape(const VertebraAnatomy& anatomy);

  /// Negative inside, at most 1 mm per mm, zero on the surface.
  template <class T>
  T operator()(const Point<T>& p) const {
    const Point<T> side{magnitude(p.x), p.y, p.z};
    T f = pruned(body_, p);
    if (right_pedicle_) {
      join(f, pedicle_, p);
      join(f, *right_pedicle_, Point<T>{p.x * -1.0, p.y, p.z});
    } else {
      join(f, pedicle_, side);
    }
    join(f, lamina_, Point<T>{soft_magnitude(p.x, kLaminaRidge), p.y, p.z});
    join(f, pars_, side);
    join(f, inferior_, side);
    join(f, superior_, side);
    join(f, mammillary_, side);
    join(f, transverse_, side);
    join(f, spinous_, p);
    if (value_of(p.y) > canal_start_) f = smooth_max(f, -canal_(p), canal_blend_);
    return f;
  }

  const PedicleShape& left_pedicle() const { return pedicle_.shape; }
  /// Mirrored to the left, as all that is given for the right side.
  const PedicleShape& right_pedicle() const { return right_pedicle_ ? right_pedicle_->shape : pedicle_.shape; }
  /// Holds the surface, fillets included.
  const Box3& bounds() const { return bounds_; }

 private:
  static constexpr double kLaminaRidge = 1.5;

  template <class Shape>
  Part<Shape> make_part(const Shape& shape, double reach, bool mirrored);

  template <class Shape, class T>
  static T ball(const Part<Shape>& part, const Point<T>& p) {
    const Point<T> q = minus(p, part.centre);
    return root(q.x * q.x + q.y * q.y + q.z * q.z) - part.radius;
  }

  template <class Shape, class T>
  static T pruned(const Part<Shape>& part, const Point<T>& p) {
    const T bound = ball(part, p);
    const T value = part.shape(p);
    return value_of(value) > value_of(bound) ? value : bound;
  }

  template <class Shape, class T>
  static void join(T& f, const Part<Shape>& part, const Point<T>& p) {
    const double dx = value_of(p.x) - part.centre.x(), dy = value_of(p.y) - part.centre.y(),
                 dz = value_of(p.z) - part.centre.z();
    const double far = value_of(f) + part.reach + part.radius;
    if (far <= 0.0 || dx * dx + dy * dy + dz * dz >= far * far) return;
    f = smooth_min(f, pruned(part, p), part.reach);
  }

  Part<BodyShape> body_;
  Part<PedicleShape> pedicle_;                       ///< both, or the left one
  std::optional<Part<PedicleShape>> right_pedicle_;  ///< where it differs; mirrored to the left
  Part<RoundPlate> lamina_;
  Part<FlatBar> pars_, inferior_, transverse_;
  Part<SuperiorArticularShape> superior_;
  Part<BallShape> mammillary_;
  Part<SpinousShape> spinous_;
  CanalShape canal_;
  double canal_start_ = 0.0, canal_blend_ = 1.0;
  Box3 bounds_;
};

FlatBar make_bar(const VertebraAnatomy::Process& process) {
  return FlatBar(process.root_mm, process.tip_mm, process.thin_direction, process.root_thickness_mm,
                 process.tip_thickness_mm, process.width_over_thickness);
}

RoundPlate make_lamina(const VertebraAnatomy::Lamina& lamina) {
  const double slope = radians(lamina.slope_deg), lean = radians(lamina.lean_deg);
  const Vec3 outward(std::cos(slope), -std::sin(slope), 0.0);  // from the middle to the pars
  const Vec3 level_back(std::sin(slope), std::cos(slope), 0.0);
  const Vec3 back = std::cos(lean) * level_back + std::sin(lean) * Vec3::UnitZ();
  const Frame frame{back, outward.cross(back), outward};
  return RoundPlate(lamina.centre_mm, frame, 0.5 * Vec3(lamina.thickness_mm, lamina.height_mm, lamina.length_mm),
                    0.48 * lamina.thickness_mm);
}

template <class Shape>
Part<Shape> VertebraShape::make_part(const Shape& shape, double reach, bool mirrored) {
  // Fillets reach at most reach/4 beyond the parts.
  const Box3 box = shape.bounds();
  const Vec3 room = Vec3::Constant(0.25 * reach);
  Box3 whole(box.min() - room, box.max() + room);
  if (mirrored) whole.extend(Vec3(-whole.max().x(), whole.min().y(), whole.min().z()));
  bounds_.extend(whole);
  // Room for the fillet and for the band in which values become distances.
  constexpr double kBand = 4.0;
  return {shape, box.center(), 0.5 * box.diagonal().norm() + reach + kBand, reach};
}

VertebraShape::VertebraShape(const VertebraAnatomy& anatomy)
    : canal_(anatomy.canal), canal_blend_(anatomy.canal.blend_mm) {
  body_ = make_part(BodyShape(anatomy.body), 0.0, false);
  pedicle_ = make_part(PedicleShape(anatomy.pedicle), anatomy.pedicle.blend_mm, true);
  if (anatomy.right_pedicle) {
    right_pedicle_ = make_part(PedicleShape(*anatomy.right_pedicle), anatomy.right_pedicle->blend_mm, true);
  }
  lamina_ = make_part(make_lamina(anatomy.lamina), anatomy.lamina.blend_mm, true);
  pars_ = make_part(make_bar(anatomy.pars), anatomy.pars.blend_mm, true);
  inferior_ = make_part(make_bar(anatomy.inferior_articular), anatomy.inferior_articular.blend_mm, true);
  superior_ = make_part(SuperiorArticularShape(anatomy.superior_articular, anatomy.facet),
                        anatomy.superior_articular.blend_mm, true);
  mammillary_ = make_part(BallShape(anatomy.mammillary.centre_mm, anatomy.mammillary.radius_mm),
                          anatomy.mammillary.blend_mm, true);
  transverse_ = make_part(make_bar(anatomy.transverse), anatomy.transverse.blend_mm, true);
  spinous_ = make_part(SpinousShape(anatomy.spinous), anatomy.spinous.blend_mm, false);
  // Further forward than this the canal lies deeper outside than the body's middle lies inside, and cuts nothing.
  canal_start_ = anatomy.canal.front_mm - anatomy.body.depth_mm - canal_blend_;
}

}  // namespace
}  // namespace spinaltap::shapes

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
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    const Vec3 p = to_own(points_mm[n]);
    values_mm[n] = value_mm(p);
    if (gradients.empty()) continue;
    gradients[n] = rotation_ * shapes::slope_of([this](const Vec3& q) { return value_mm(q); }, p);
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
    return lerp(lerp(body, pedicle, behind_body), arch, in_arch);
  };
  const double hollow = std::max(anatomy_.body.superior_hollow_mm, anatomy_.body.inferior_hollow_mm);
  const double at_endplate = smooth_step(half_height - hollow - 3.0, half_height - hollow - 1.0, std::fabs(p.z()));
  const double wall = lerp(cortex.body_wall_mm, cortex.endplate_mm, at_endplate);
  const double shell = blend(wall, cortex.pedicle_mm, cortex.posterior_mm);
  const double depth = -distance_mm;
  const double cortical =
      aperture_mm > 0.0 ? std::clamp((shell - depth) / aperture_mm + 0.5, 0.0, 1.0) : (depth < shell ? 1.0 : 0.0);
  if (cortical >= 1.0) return cortex.hu;
  const double core =
      blend(bone.body_hu, bone.pedicle_hu, bone.posterior_hu) + bone.texture_hu * inside_->texture.at(p);
  return lerp(core, cortex.hu, cortical);
}

Vec3 Vertebra::to_patient(const Vec3& p_own) const { return rotation_ * p_own + anatomy_.placement.position_mm; }

Vec3 Vertebra::to_own(const Vec3& p_patient) const {
  return rotation_.transpose() * (p_patient - anatomy_.placement.position_mm);
}

}  // namespace spinaltap

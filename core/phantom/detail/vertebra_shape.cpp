#include "core/phantom/detail/vertebra_shape.h"

namespace spinaltap::shapes {
namespace {

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

}  // namespace

template <class Shape>
VertebraShape::Part<Shape> VertebraShape::make_part(const Shape& shape, double reach, bool mirrored) {
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

}  // namespace spinaltap::shapes

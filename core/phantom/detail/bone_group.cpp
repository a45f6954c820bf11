#include "core/phantom/detail/bone_group.h"

namespace spinaltap::shapes {

template <class Shape>
BoneGroup::Piece<Shape> BoneGroup::make_piece(const Shape& shape) {
  constexpr double kRoom = 5.0;  // for the band in which values become distances
  const Box3 box = shape.bounds();
  // Fillets reach at most a quarter of their reach beyond, the crease no further than its width.
  const Vec3 room = Vec3::Constant(0.25 * reach_ + (is_paired_ ? kCrease : 0.0));
  bounds_.extend(Box3(box.min() - room, box.max() + room));
  return {shape, box.center(), 0.5 * box.diagonal().norm() + reach_ + kRoom};
}

BoneGroup::BoneGroup(const std::vector<FlatBar>& bars, const std::vector<RoundPlate>& plates, double reach,
                     bool is_paired)
    : reach_(reach), is_paired_(is_paired) {
  for (const FlatBar& bar : bars) bars_.push_back(make_piece(bar));
  for (const RoundPlate& plate : plates) plates_.push_back(make_piece(plate));
  if (is_paired) {
    const Box3 left = bounds_;
    bounds_.extend(Vec3(-left.max().x(), left.min().y(), left.min().z()));
    bounds_.extend(Vec3(-left.min().x(), left.max().y(), left.max().z()));
  }
}

void add_bars(std::vector<FlatBar>& bars, const std::vector<BarKnot>& knots, const Vec3& thin_direction,
              double width_over_thickness) {
  for (std::size_t n = 1; n < knots.size(); ++n) {
    bars.emplace_back(knots[n - 1].place_mm, knots[n].place_mm, thin_direction, knots[n - 1].thickness_mm,
                      knots[n].thickness_mm, width_over_thickness);
  }
}

}  // namespace spinaltap::shapes

#include "core/phantom/vertebra_ground_truth.h"

#include <cmath>

#include "core/base/error.h"
#include "core/phantom/detail/vertebra_parts.h"

namespace spinaltap {
namespace {

double value_at(const Vertebra& vertebra, const Vec3& p) {
  double value = 0.0;
  vertebra.evaluate({&p, 1}, {&value, 1}, {});
  return value;
}

/// First point where a ray from inside leaves the bone, by sphere tracing and then bisection.
Vec3 way_out(const Vertebra& vertebra, const Vec3& start, const Vec3& direction) {
  constexpr double kFarthest = 200.0, kMinStep = 0.01;
  double inside = 0.0, outside = 0.0;
  while (true) {
    const double value = value_at(vertebra, start + outside * direction);
    if (value > 0.0) break;
    inside = outside;
    outside += std::max(-value, kMinStep);
    if (outside > kFarthest) fail("vertebra: a pedicle's axis does not leave the bone within ", kFarthest, " mm");
  }
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (inside + outside);
    (value_at(vertebra, start + middle * direction) > 0.0 ? outside : inside) = middle;
  }
  return start + inside * direction;
}

PedicleGroundTruth pedicle_ground_truth(const Vertebra& vertebra, double side) {
  constexpr double kLeftInFront = 8.0;  // mm of bone beyond the target
  const VertebraAnatomy& anatomy = vertebra.anatomy();
  const VertebraAnatomy::Pedicle& pedicle =
      side < 0.0 && anatomy.right_pedicle ? *anatomy.right_pedicle : anatomy.pedicle;
  const shapes::PedicleShape shape(pedicle);
  const Vec3 mirror(side, 1.0, 1.0);
  const auto turned = [&](const Vec3& direction) { return Vec3(vertebra.rotation() * direction.cwiseProduct(mirror)); };
  PedicleGroundTruth ground_truth;
  ground_truth.isthmus_mm = vertebra.to_patient(pedicle.isthmus_mm.cwiseProduct(mirror));
  ground_truth.axis = turned(shape.forward());
  ground_truth.width_axis = turned(shape.sideways());
  ground_truth.height_axis = turned(shape.upward());
  ground_truth.width_mm = pedicle.width_mm;
  ground_truth.height_mm = pedicle.height_mm;
  ground_truth.entry_mm = way_out(vertebra, ground_truth.isthmus_mm, -ground_truth.axis);
  ground_truth.target_mm =
      way_out(vertebra, ground_truth.isthmus_mm, ground_truth.axis) - kLeftInFront * ground_truth.axis;
  const double own_y = vertebra.to_own(ground_truth.target_mm).y();
  if (!(own_y < 0.5 * anatomy.body.depth_mm)) {
    fail("vertebra: the pedicle's axis must enter the body, but leaves the bone at y = ", own_y, " mm");
  }
  return ground_truth;
}

}  // namespace

VertebraGroundTruth vertebra_ground_truth(const Vertebra& vertebra) {
  return {pedicle_ground_truth(vertebra, 1.0), pedicle_ground_truth(vertebra, -1.0)};
}

}  // namespace spinaltap

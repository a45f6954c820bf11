#pragma once

#include <cstdint>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/phantom/vertebra.h"

namespace spinaltap::test {

/// Numbers of one seed, one after the other.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : seed_(seed) {}
  double within(double low, double high) { return low + (high - low) * random_uniform(seed_, next_++); }
  Vec3 within_box(double half) {
    const double x = within(-half, half), y = within(-half, half), z = within(-half, half);
    return {x, y, z};
  }

 private:
  std::uint64_t seed_, next_ = 0;
};

inline void scale(VertebraAnatomy::Process& process, const Vec3& by, double thickness) {
  process.root_mm = process.root_mm.cwiseProduct(by);
  process.tip_mm = process.tip_mm.cwiseProduct(by);
  process.root_thickness_mm *= thickness;
  process.tip_thickness_mm *= thickness;
}

/// The shipped vertebra, `by` times as large along its own axes.
inline VertebraAnatomy scaled_anatomy(const Vec3& by) {
  VertebraAnatomy a;
  a.body.width_mm *= by.x();
  a.body.depth_mm *= by.y();
  a.body.height_mm *= by.z();
  a.pedicle.isthmus_mm = a.pedicle.isthmus_mm.cwiseProduct(by);
  a.pedicle.width_mm *= by.x();
  a.pedicle.height_mm *= by.z();
  a.canal.width_mm *= by.x();
  a.canal.front_mm *= by.y();
  a.canal.back_mm *= by.y();
  const double across = 0.5 * (by.x() + by.y());
  scale(a.transverse, by, across);
  scale(a.superior_articular, by, across);
  scale(a.inferior_articular, by, across);
  scale(a.pars, by, across);
  a.mammillary.centre_mm = a.mammillary.centre_mm.cwiseProduct(by);
  a.lamina.centre_mm = a.lamina.centre_mm.cwiseProduct(by);
  a.lamina.length_mm *= across;
  a.lamina.thickness_mm *= across;
  a.lamina.height_mm *= by.z();
  for (Eigen::Vector2d& corner : a.spinous.outline_mm) corner = corner.cwiseProduct(Eigen::Vector2d(by.y(), by.z()));
  return a;
}

/// Moves and turns a pedicle, and changes its section, by up to what one vertebra's two sides differ and more.
inline void disturb(VertebraAnatomy::Pedicle& pedicle, RandomNumbers& random) {
  pedicle.width_mm *= random.within(0.85, 1.15);
  pedicle.height_mm *= random.within(0.9, 1.1);
  pedicle.isthmus_mm += random.within_box(0.8);
  pedicle.convergence_deg += random.within(-6.0, 6.0);
  pedicle.tilt_deg += random.within(-5.0, 5.0);
}

/// A vertebra like the shipped one: 12% larger or smaller along each of its axes, with two different pedicles, turned
/// by up to 20 degrees about any axis and moved by up to 100 mm; every second one has the thin cortex (0.4 mm and less
/// around the body) and the empty core of osteoporosis. The same seed always gives the same one, and one whose
/// isthmuses are exact.
inline VertebraAnatomy random_anatomy(std::uint64_t seed) {
  constexpr std::uint64_t kMaxDraws = 1000;
  for (std::uint64_t draw = 0; draw < kMaxDraws; ++draw) {
    RandomNumbers random(mix_bits(seed) + draw);
    const double width = random.within(0.88, 1.12), depth = random.within(0.88, 1.12);
    VertebraAnatomy a = scaled_anatomy({width, depth, random.within(0.88, 1.12)});
    a.body.waist_mm = random.within(1.2, 3.0);
    a.body.kidney_mm = random.within(3.0, 5.0);
    a.body.superior_hollow_mm = random.within(1.0, 2.8);
    a.body.inferior_hollow_mm = random.within(1.5, 3.2);
    a.right_pedicle = a.pedicle;
    disturb(a.pedicle, random);
    disturb(*a.right_pedicle, random);
    if (seed % 2 == 1) {
      a.cortex = {1300.0, 0.4, 0.25, 0.6, 0.7};  // walls of old vertebrae; the bone of the cortex stays as dense
      a.cancellous.body_hu = random.within(40.0, 90.0);
      a.cancellous.pedicle_hu = a.cancellous.body_hu + 60.0;
      a.cancellous.posterior_hu = a.cancellous.body_hu + 120.0;
    }
    a.cancellous.texture_seed = mix_bits(seed);
    a.placement.position_mm = random.within_box(100.0);
    const Vec3 axis = random.within_box(1.0).normalized();
    const Mat3 turn = Eigen::AngleAxisd(random.within(0.0, 20.0) * kDegree, axis).toRotationMatrix();
    // As turns about x, then y, then z of the patient.
    const Vec3 zyx = turn.eulerAngles(2, 1, 0);
    a.placement.rotation_deg = Vec3(zyx[2], zyx[1], zyx[0]) / kDegree;
    try {
      (void)Vertebra(a);
      return a;
    } catch (const Error&) {  // a fillet reaches an isthmus
    }
  }
  fail("random anatomy: no vertebra of seed ", seed, " has exact isthmuses");
}

}  // namespace spinaltap::test

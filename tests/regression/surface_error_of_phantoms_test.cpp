// How well a CT shows a vertebra's surface, as is told of it, against the phantom's ground truth: the whole chain from
// a CT without a label map, in slices of 0.5 to 5 mm.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <ostream>

#include "core/anatomy/bone_shape.h"
#include "core/phantom/scanner.h"
#include "core/phantom/vertebra.h"
#include "tests/support/test_kind.h"
#include "vdb/sim/bake_ct.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

WHOLE_RUNS("*SurfaceErrorOfPhantoms.*");

struct Scan {
  double step_mm, width_mm, noise_hu;
  bool is_other = false;  ///< an anatomy, pixels and blur that the model's numbers were not found on

  friend void PrintTo(const Scan& scan, std::ostream* out) { *out << scan.step_mm << " by " << scan.width_mm << " mm"; }
};

/// Distances of the found surface from the true one, and what was told of each place.
struct Measured {
  double found_mm = 0.0;  ///< root mean square
  double told_mm = 0.0;   ///< likewise, by the surface's directions
  double in_band = 0.0;   ///< share of the places that lie within their 95 % band
  double p95_found_mm = 0.0;
};

std::shared_ptr<const Vertebra> solid_of(const Scan& scan) {
  VertebraAnatomy anatomy;
  if (scan.is_other) {
    anatomy.pedicle.width_mm = 7.4;
    anatomy.placement = {Vec3(3.3, -7.1, 41.7), Vec3(9.0, -6.0, 14.0)};
  }
  return std::make_shared<const Vertebra>(anatomy);
}

Measured measured(const Scan& scan) {
  const std::shared_ptr<const Vertebra> solid = solid_of(scan);
  ScanOptions options;
  options.pixel_mm = scan.is_other ? 0.55 : 0.7;
  options.blur_mm = scan.is_other ? 0.65 : 0.5;
  options.slice_step_mm = scan.step_mm;
  options.slice_width_mm = scan.width_mm;
  options.noise_hu = scan.noise_hu;
  const Box3 box_mm = solid->bounds_mm();
  const CtVolume ct = spinaltap::scan(
      *solid, scan_of_box({box_mm.min() - Vec3::Constant(12.0), box_mm.max() + Vec3::Constant(12.0)}, options));
  const Bone bone(bake_ct(ct).bone);
  const CtSurfaceError told = bone.surface_error().value();
  const BoneShape truth(solid, box_mm, 0.3);
  constexpr std::size_t kStride = 7;
  Measured result;
  std::vector<double> distances_mm;
  double found = 0.0, stated = 0.0;
  std::size_t within = 0;
  for (std::size_t n = 0; n < bone.shape().points_mm().size(); n += kStride) {
    const double off_mm = std::abs(truth.distance_mm(bone.shape().points_mm()[n]));
    const double there_mm = told.standard_error_mm(bone.shape().normals()[n]);
    found += off_mm * off_mm;
    stated += there_mm * there_mm;
    within += off_mm <= 1.96 * there_mm ? 1 : 0;
    distances_mm.push_back(off_mm);
  }
  const auto count = static_cast<double>(distances_mm.size());
  std::sort(distances_mm.begin(), distances_mm.end());
  result.found_mm = std::sqrt(found / count);
  result.told_mm = std::sqrt(stated / count);
  result.in_band = static_cast<double>(within) / count;
  result.p95_found_mm = distances_mm[distances_mm.size() * 95 / 100];
  std::printf(
      "%.2f mm every %.2f mm, %.0f HU%s: surface off by %.3f mm (95 %% %.3f), told %.3f mm, %.1f %% in the band\n",
      scan.width_mm, scan.step_mm, scan.noise_hu, scan.is_other ? ", other vertebra" : "", result.found_mm,
      result.p95_found_mm, result.told_mm, 100.0 * result.in_band);
  EXPECT_NEAR(told.standard_error_mm(), result.told_mm, 0.02 * result.told_mm) << "the whole is the mean of its places";
  return result;
}

class SurfaceErrorOfPhantoms : public testing::TestWithParam<Scan> {};

TEST_P(SurfaceErrorOfPhantoms, IsNeverMoreThanToldAndNotMuchLess) {
  const Measured scan = measured(GetParam());
  EXPECT_GE(scan.told_mm, scan.found_mm);
  // What overlapping slices lose is bounded; how much of it the edge's model gets back differs from CT to CT.
  const bool overlaps = GetParam().width_mm > 1.2 * GetParam().step_mm;
  EXPECT_LE(scan.told_mm, (overlaps ? 3.0 : 1.5) * scan.found_mm);
  EXPECT_GE(scan.in_band, 0.95);
}

INSTANTIATE_TEST_SUITE_P(Slices, SurfaceErrorOfPhantoms,
                         testing::Values(Scan{0.5, 0.5, 15.0}, Scan{1.0, 1.0, 15.0}, Scan{1.5, 1.5, 15.0},
                                         Scan{2.0, 2.0, 15.0}, Scan{2.5, 2.5, 15.0}, Scan{3.0, 3.0, 15.0},
                                         Scan{4.0, 4.0, 15.0}, Scan{5.0, 5.0, 15.0}));
INSTANTIATE_TEST_SUITE_P(Overlapping, SurfaceErrorOfPhantoms,
                         testing::Values(Scan{1.0, 3.0, 15.0}, Scan{1.0, 5.0, 15.0}, Scan{2.5, 5.0, 15.0}));
INSTANTIATE_TEST_SUITE_P(NotSeenBefore, SurfaceErrorOfPhantoms,
                         testing::Values(Scan{0.75, 0.75, 25.0, true}, Scan{1.25, 1.25, 25.0, true},
                                         Scan{2.2, 2.2, 25.0, true}, Scan{3.5, 3.5, 25.0, true},
                                         Scan{4.5, 4.5, 25.0, true}));

}  // namespace
}  // namespace spinaltap

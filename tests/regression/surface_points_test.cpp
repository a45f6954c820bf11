// How far the surface points of the three methods lie from the ground truth of a scanned phantom, and how they wiggle
// from slice to slice. Pixels of 0.352 mm, slices of 0.5 mm.

#include <gtest/gtest.h>

#include <algorithm>

#include "core/phantom/scanner.h"
#include "core/phantom/vertebra.h"
#include "core/segment/segment_spine.h"
#include "core/surface/surface_samples.h"
#include "tests/support/mesh_of_real_vertebra.h"
#include "tests/support/point_error.h"
#include "tests/support/test_data.h"
#include "tests/support/test_kind.h"
#include "vdb/grid/mesh_solid.h"

namespace spinaltap {
namespace {

void expect_points_on(const Solid& solid) {
  ScanOptions options;
  const double height_mm = solid.bounds_mm().sizes().z() + 6.0;
  options.slices = std::max(options.slices, static_cast<int>(height_mm / options.slice_step_mm));
  const CtVolume ct = scan(solid, options);
  const BoneMask mask = segment_vertebra(ct).mask;
  const auto error_of = [&](PointMethod method, const char* name) {
    const SurfaceSamples samples = sample_surface(ct, mask, {.method = method});
    const test::PointError error =
        test::point_error(std::span(samples.positions_mm).first(samples.surface_count), solid, options.slice_step_mm);
    std::printf(
        "%-9s %7zu surface, %7zu off-surface points; mean %.4f mm (99%% %.3f, max %.3f, bias %+.4f), "
        "inter-slice jitter %.4f mm\n",
        name, samples.surface_count, samples.positions_mm.size() - samples.surface_count, error.mean_mm, error.p99_mm,
        error.max_mm, error.bias_mm, error.inter_slice_jitter_mm);
    return error;
  };
  const test::PointError pixels = error_of(PointMethod::pixels, "pixels");
  const test::PointError normals = error_of(PointMethod::normals, "normals");
  const test::PointError contours = error_of(PointMethod::contours, "contours");
  EXPECT_LE(contours.mean_mm, 0.08);
  EXPECT_LE(contours.p99_mm, 0.35);
  EXPECT_LT(contours.inter_slice_jitter_mm, 0.5 * normals.inter_slice_jitter_mm);
  EXPECT_LT(contours.inter_slice_jitter_mm, 0.5 * pixels.inter_slice_jitter_mm);
}

WHOLE_RUNS("SurfacePointsOfScans.*");

TEST(SurfacePointsOfScans, LieOnThePhantom) { expect_points_on(Vertebra()); }

TEST(SurfacePointsOfScans, LieOnTheMeshOfARealVertebra) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_mesh")
  expect_points_on(*make_mesh_solid(test::read_real_vertebra(folder)));
}

}  // namespace
}  // namespace spinaltap

// Compiled with optimisation: whole CTs are searched for bodies.
//
// Whether random trunks are like real CTs: noise in soft tissue, CT numbers of cancellous bone and of bodies' walls,
// sizes of bodies, all measured alike, by the cylinders that are found. See tests/support/test_data.h.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "core/ct/read_ct.h"
#include "core/phantom/random_trunk.h"
#include "core/phantom/spine.h"
#include "core/segment/spine_bodies.h"
#include "tests/support/test_data.h"
#include "tests/support/test_kind.h"
#include "tests/trunks/trunk_exam.h"

namespace spinaltap {
namespace {

WHOLE_RUNS("TrunkLikeness.*");

struct CtFigures {
  std::size_t bodies = 0;
  double noise_hu = 0.0, cancellous_hu = 0.0, wall_hu = 0.0;  ///< medians over the bodies
  Vec3 size_mm = Vec3::Zero();                                ///< medians
};

double quantile_of(std::vector<double> values, double share = 0.5) {
  if (values.empty()) return 0.0;
  const auto n = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + n, values.end());
  return values[static_cast<std::size_t>(n)];
}

CtFigures figures_of(const CtVolume& ct) {
  const SpineBodies spine = find_spine_bodies(ct);
  CtFigures figures;
  figures.noise_hu = spine.levels.noise_hu;
  std::vector<double> cores, walls;
  std::array<std::vector<double>, 3> sizes;
  for (std::size_t n = spine.has_sacrum ? 1 : 0; n < spine.bodies.size(); ++n) {
    if (spine.chain[n].is_cut()) continue;
    const BodyCylinder& body = spine.bodies[n].cylinder;
    const Mat3 axes = body.axes();
    std::vector<double> core, wall;
    for (double x = -1.15; x <= 1.15; x += 0.05) {
      for (double y = -1.15; y <= 1.15; y += 0.05) {
        for (double z = -0.5; z <= 0.5; z += 0.1) {
          const double out = std::hypot(x, y);
          const double hu = sample_hu(ct, body.centre_mm + axes * Vec3(x, y, z).cwiseProduct(body.half_mm));
          if (out < 0.6) core.push_back(hu);
          if (out > 0.8 && out < 1.15) wall.push_back(hu);
        }
      }
    }
    cores.push_back(quantile_of(core));
    walls.push_back(quantile_of(wall, 0.9));
    for (std::size_t axis = 0; axis < 3; ++axis) sizes[axis].push_back(2.0 * body.half_mm[static_cast<int>(axis)]);
  }
  figures.bodies = cores.size();
  figures.cancellous_hu = quantile_of(cores);
  figures.wall_hu = quantile_of(walls);
  figures.size_mm = Vec3(quantile_of(sizes[0]), quantile_of(sizes[1]), quantile_of(sizes[2]));
  return figures;
}

void print_figures(const std::string& what, const CtVolume& ct, const CtFigures& f) {
  std::printf(
      "%-34s %4.2f x %3.1f mm, %2zu bodies: noise %5.1f, cancellous %4.0f, wall %4.0f HU, %4.1f x %4.1f x %4.1f mm\n",
      what.c_str(), ct.geometry.spacing_mm.x(), ct.geometry.spacing_mm.z(), f.bodies, f.noise_hu, f.cancellous_hu,
      f.wall_hu, f.size_mm.x(), f.size_mm.y(), f.size_mm.z());
  std::fflush(stdout);
}

TEST(TrunkLikeness, OfRandomTrunksHoldsRealCtsAmidThem) {
  SPINALTAP_NEED_TEST_DATA(spine_folder, "thoracic_spine_ct")
  SPINALTAP_NEED_TEST_DATA(stent_folder, "thoracic_ct_stent_1.5mm")
  SPINALTAP_NEED_TEST_DATA(abdomen_folder, "abdomen_pelvis_3mm")
  SPINALTAP_NEED_TEST_DATA(l3_folder, "L3_ct_1.5mm")
  std::vector<CtFigures> reals;
  for (const auto& file : {spine_folder / "lidc-0314_spine.nii.gz", stent_folder / "ct_cropped.nii.gz",
                           abdomen_folder / "example_ct.nii.gz", l3_folder / "sub-ct_label-22_ct.nii.gz"}) {
    const CtVolume ct = read_ct(file);
    reals.push_back(figures_of(ct));
    print_figures(file.filename().string(), ct, reals.back());
  }
  std::vector<CtFigures> phantoms;
  for (std::uint64_t seed = 0; seed < 32; seed += 2) {
    const TrunkOptions options = random_trunk_options(seed);
    const CtVolume ct = test::scan_trunk(Spine(options.spine), options);
    phantoms.push_back(figures_of(ct));
    print_figures("seed " + std::to_string(seed), ct, phantoms.back());
  }
  for (const double CtFigures::*const figure : {&CtFigures::noise_hu, &CtFigures::cancellous_hu, &CtFigures::wall_hu}) {
    const auto less = [&](const CtFigures& x, const CtFigures& y) { return x.*figure < y.*figure; };
    const auto [low, high] = std::minmax_element(phantoms.begin(), phantoms.end(), less);
    for (const CtFigures& real : reals) {
      if (real.bodies == 0) continue;
      // Sixteen patients are few: a quarter beyond them.
      EXPECT_GE(real.*figure, 0.75 * ((*low).*figure));
      EXPECT_LE(real.*figure, 1.25 * ((*high).*figure));
    }
  }
}

}  // namespace
}  // namespace spinaltap

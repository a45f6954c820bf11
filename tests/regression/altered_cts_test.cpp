// Compiled with optimisation: whole CTs are resampled.
//
// Whether bodies that are found in a real CT are found in the same CT altered: crushed, tilted, in thicker slices, of a
// sharper kernel and a lower dose, of lighter bone, of a larger or smaller patient. See tests/support/test_data.h.

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "core/ct/read_ct.h"
#include "core/segment/row_gaps.h"
#include "core/segment/spine_bodies.h"
#include "tests/support/altered_ct.h"
#include "tests/support/test_data.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using namespace test;

WHOLE_RUNS("AlteredCts.*");

struct Altered {
  std::string name;
  CtVolume ct;
  std::function<Vec3(const Vec3&)> to_new;
};

struct Count {
  int whole = 0, found = 0, extra = 0, untold = 0;
};

std::vector<BodyCylinder> whole_bodies(const SpineBodies& spine) {
  std::vector<BodyCylinder> whole;
  for (std::size_t n = spine.has_sacrum ? 1 : 0; n < spine.bodies.size(); ++n) {
    if (!spine.chain[n].is_cut()) whole.push_back(spine.bodies[n].cylinder);
  }
  return whole;
}

/// Bodies of the CT as it is that are found in the altered one, within 7 mm: a third of the smallest's step.
void count(const std::vector<BodyCylinder>& whole, const Altered& altered, Count& sum) {
  constexpr double kNearMm = 7.0;
  const SpineBodies spine = find_spine_bodies(altered.ct);
  std::vector<bool> is_known(spine.bodies.size(), false);
  int found = 0;
  for (const BodyCylinder& body : whole) {
    const Vec3 place_mm = altered.to_new(body.centre_mm);
    for (std::size_t n = 0; n < spine.bodies.size(); ++n) {
      if (is_known[n] || (spine.bodies[n].cylinder.centre_mm - place_mm).norm() > kNearMm) continue;
      is_known[n] = true;
      ++found;
      break;
    }
  }
  int extra = 0;
  for (std::size_t n = spine.has_sacrum ? 1 : 0; n < is_known.size(); ++n) {
    if (!is_known[n] && !spine.chain[n].is_cut()) ++extra;
  }
  const auto all = static_cast<int>(whole.size());
  const bool is_untold = found < all && gaps_in_row(spine).empty();
  std::printf("%-24s found %2d of %2d, others %d%s\n", altered.name.c_str(), found, all, extra,
              is_untold ? ", no word" : "");
  sum.whole += all;
  sum.found += found;
  sum.extra += extra;
  sum.untold += is_untold ? all - found : 0;
}

/// All alterations of a CT, one after the other.
Count count_all(const CtVolume& ct) {
  const std::vector<BodyCylinder> whole = whole_bodies(find_spine_bodies(ct));
  Count sum;
  const auto as_it_is = [](const Vec3& p_mm) { return p_mm; };
  for (std::size_t n = 1; n + 1 < whole.size(); n += 2) {
    for (const double share : {0.5, 0.36}) {
      const double z = whole[n].centre_mm.z(), half_mm = whole[n].half_mm.z();
      const Crush crush{z - half_mm, z + half_mm, share};
      count(whole,
            {"crushed " + std::to_string(n) + " to " + std::to_string(2.0 * half_mm * share).substr(0, 4) + " mm",
             crushed(ct, crush), [&](const Vec3& p_mm) { return crush.to_new(p_mm); }},
            sum);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const double deg : {-15.0, 15.0}) {
      const Turn turn{axis, deg};
      count(whole,
            {"turned about " + std::string(1, "xyz"[axis]) + (deg < 0.0 ? " by -15" : " by 15"), turned(ct, turn),
             [&](const Vec3& p_mm) { return turn(ct, p_mm, 1.0); }},
            sum);
    }
  }
  count(whole, {"0.6 x 1.6 mm", resliced(ct, 0.6, 1.6, 1.6), as_it_is}, sum);
  count(whole, {"0.75 x 2.2 mm", resliced(ct, 0.75, 2.2, 2.2), as_it_is}, sum);
  count(whole, {"0.7 x 2.5 mm, 4 wide", resliced(ct, 0.7, 2.5, 4.0), as_it_is}, sum);
  count(whole, {"0.85 x 3.5 mm", resliced(ct, 0.85, 3.5, 3.5), as_it_is}, sum);
  count(whole, {"sharper, noise 80", sharpened(ct, 1.0, 80.0, 11), as_it_is}, sum);
  count(whole, {"much sharper, noise 40", sharpened(ct, 2.2, 40.0, 12), as_it_is}, sum);
  count(whole, {"bone times 0.6", with_light_bone(ct, 0.6), as_it_is}, sum);
  for (const double by : {0.8, 1.1}) {
    count(whole,
          {by < 1.0 ? "patient times 0.8" : "patient times 1.1", scaled_by(ct, by),
           [&](const Vec3& p_mm) { return Vec3(by * p_mm); }},
          sum);
  }
  std::printf("found %d of %d, others %d, missed without a word %d\n", sum.found, sum.whole, sum.extra, sum.untold);
  return sum;
}

TEST(AlteredCts, OfAThoracicSpineShowItsBodies) {
  SPINALTAP_NEED_TEST_DATA(folder, "thoracic_spine_ct")
  const Count sum = count_all(read_ct(folder / "lidc-0314_spine.nii.gz"));
  EXPECT_GE(sum.found, sum.whole * 19 / 20);
}

TEST(AlteredCts, OfAChestWithAStentShowItsBodies) {
  SPINALTAP_NEED_TEST_DATA(folder, "thoracic_ct_stent_1.5mm")
  const Count sum = count_all(read_ct(folder / "ct_cropped.nii.gz"));
  EXPECT_GE(sum.found, sum.whole * 9 / 10);
}

TEST(AlteredCts, OfAnAbdomenShowItsBodies) {
  SPINALTAP_NEED_TEST_DATA(folder, "abdomen_pelvis_3mm")
  const Count sum = count_all(read_ct(folder / "example_ct.nii.gz"));
  EXPECT_GE(sum.found, sum.whole * 3 / 4);
}

}  // namespace
}  // namespace spinaltap

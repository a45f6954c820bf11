#include "apps/common/bone_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "core/base/error.h"
#include "core/phantom/vertebra_truth.h"
#include "tests/support/analytic_bodies.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

VertebraAnatomy placed() {
  VertebraAnatomy anatomy;
  anatomy.placement.position_mm = Vec3(12.0, -30.0, 400.0);
  anatomy.placement.rotation_deg = Vec3(7.0, -5.0, 11.0);
  return anatomy;
}

double distance_mm(const Solid& solid, const Vec3& p) {
  double value = 0.0;
  solid.evaluate({&p, 1}, {&value, 1}, {});
  return value;
}

/// The path through a vertebra in the middle or placed elsewhere, looked for once for all tests.
class SuggestedPath : public testing::TestWithParam<bool> {
 protected:
  static const DrillPath& path_through(const Vertebra& vertebra) {
    static std::map<bool, DrillPath> paths;
    const auto found = paths.find(GetParam());
    if (found != paths.end()) return found->second;
    return paths[GetParam()] = suggest_path(bake_solid(vertebra, {.voxel_mm = 0.5}, 40.0), {});
  }

  Vertebra vertebra_{GetParam() ? placed() : VertebraAnatomy()};
  DrillPath path_ = path_through(vertebra_);
};

TEST_P(SuggestedPath, KeepsItsDistanceFromTheSurfaceOnTheWayThroughAPedicle) {
  const DrillPath& path = path_;
  // From behind into the body.
  EXPECT_LT(path.direction().y(), -0.7);
  EXPECT_GE(path.length_mm(), 38.0);
  double least_mm = std::numeric_limits<double>::infinity();
  for (double depth_mm = 8.0; depth_mm <= path.length_mm(); depth_mm += 0.1) {
    least_mm = std::min(least_mm, -distance_mm(vertebra_, path.entry_mm + depth_mm * path.direction()));
  }
  std::printf("least clearance between 8 mm after the entry and the target: %.2f mm\n", least_mm);
  EXPECT_GE(least_mm, 2.5);

  // Through the ellipse of the isthmus, of one side.
  const VertebraTruth truth = vertebra_truth(vertebra_);
  int through = 0;
  for (const PedicleTruth& pedicle : {truth.left, truth.right}) {
    const double way = (pedicle.isthmus_mm - path.entry_mm).dot(pedicle.axis) / path.direction().dot(pedicle.axis);
    const Vec3 from_centre = path.entry_mm + way * path.direction() - pedicle.isthmus_mm;
    const double across = from_centre.dot(pedicle.width_axis) / (0.5 * pedicle.width_mm);
    const double up = from_centre.dot(pedicle.height_axis) / (0.5 * pedicle.height_mm);
    through += across * across + up * up < 1.0 ? 1 : 0;
  }
  EXPECT_EQ(through, 1);
}

TEST_P(SuggestedPath, StartsAtTheBonesBackAndEndsInItsBody) {
  const DrillPath& path = path_;
  // The search steps by half a millimetre through voxels of one.
  EXPECT_LT(std::abs(distance_mm(vertebra_, path.entry_mm)), 1.5);
  EXPECT_LT(distance_mm(vertebra_, path.target_mm), -4.0);
  EXPECT_GT(distance_mm(vertebra_, path.entry_mm - 3.0 * path.direction()), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Of, SuggestedPath, testing::Bool(), [](const auto& instance) {
  return instance.param ? std::string("ATurnedVertebra") : std::string("AVertebra");
});

TEST(SuggestPath, FindsNoneThroughABallWithoutPedicles) {
  const BoneModel small = test::bake_ball({Vec3::Zero(), 6.0}, 0.5);
  EXPECT_THAT([&] { suggest_path(small, {}); }, ThrowsMessage<Error>(HasSubstr("--entry")));
}

}  // namespace
}  // namespace spinaltap

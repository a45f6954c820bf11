#include "vdb/sim/bone_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/analytic_bodies.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(PathMeetsBone, WhenAnyOfItIsInside) {
  const BoneModel ball = test::bake_ball({Vec3(5.0, 0.0, 0.0), 6.0}, 0.5);
  EXPECT_NO_THROW(check_path_meets_bone({"through", Vec3(-20.0, 0.0, 0.0), Vec3(30.0, 0.0, 0.0), {}}, ball));
  EXPECT_NO_THROW(check_path_meets_bone({"ends inside", Vec3(20.0, 0.0, 0.0), Vec3(10.5, 0.0, 0.0), {}}, ball));
  EXPECT_THAT(
      [&] {
        check_path_meets_bone({"beside", Vec3(-20.0, 6.5, 0.0), Vec3(30.0, 6.5, 0.0), {}}, ball);
      },
      ThrowsMessage<Error>(AllOf(HasSubstr("beside"), HasSubstr("misses the bone"))));
  EXPECT_THAT(
      [&] {
        check_path_meets_bone({"short", Vec3(20.0, 0.0, 0.0), Vec3(11.5, 0.0, 0.0), {}}, ball);
      },
      ThrowsMessage<Error>(HasSubstr("misses the bone")));
}

}  // namespace
}  // namespace spinaltap

#include "apps/report/picture_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "tests/support/analytic_bodies.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const test::Ball kSeenBall{Vec3(3.0, -2.0, 105.0), 6.0};

const BoneModel& seen_bone() {
  static const BoneModel model = test::bake_ball(kSeenBall, 0.5);
  return model;
}

/// On the patient's left, forward and towards the middle, a little upward.
DrillPath path_on_the_left() {
  return {"left", kSeenBall.centre_mm + Vec3(4.0, 4.0, -1.0), kSeenBall.centre_mm + Vec3(1.0, -4.0, 1.0), {}};
}

TEST(NamedView, LooksFromWhereItsNameSays) {
  const DrillPath path = path_on_the_left();
  // LPS: x to the patient's left, y to the back, z to the head.
  EXPECT_EQ(named_view("behind", &path, seen_bone()).from, Vec3::UnitY());
  EXPECT_EQ(named_view("front", nullptr, seen_bone()).from, -Vec3::UnitY());
  EXPECT_EQ(named_view("left", nullptr, seen_bone()).from, Vec3::UnitX());
  EXPECT_EQ(named_view("right", nullptr, seen_bone()).from, -Vec3::UnitX());
  EXPECT_EQ(named_view("above", nullptr, seen_bone()).from, Vec3::UnitZ());
  EXPECT_EQ(named_view("below", nullptr, seen_bone()).from, -Vec3::UnitZ());
  for (const char* name : {"behind", "front", "left", "right", "above", "below", "hole", "0,0,2", "1,-1,0.5"}) {
    const PictureView view = named_view(name, &path, seen_bone());
    EXPECT_GT(view.from.cross(view.up).norm(), 0.5) << name;
  }
  EXPECT_NEAR((named_view("2,0,0", nullptr, seen_bone()).from - Vec3::UnitX()).norm(), 0.0, 1e-15);
  // Looks into the hole.
  EXPECT_GT(named_view("hole", &path, seen_bone()).from.normalized().dot(-path.direction()), 0.8);
}

TEST(NamedView, IsRejectedWhereThereIsNone) {
  for (const char* name : {"", "top", "1,2", "1,2,3,4", "0,0,0", "a,b,c", "1,2,nan"}) {
    EXPECT_THAT([&] { named_view(name, nullptr, seen_bone()); }, ThrowsMessage<Error>(HasSubstr("expected behind")))
        << name;
  }
  EXPECT_THAT([&] { named_view("hole", nullptr, seen_bone()); }, ThrowsMessage<Error>(HasSubstr("--plan")));
}

TEST(NamedCut, GoesThroughThePathsMiddle) {
  const DrillPath path = path_on_the_left();
  const Vec3 middle_mm = 0.5 * (path.entry_mm + path.target_mm);
  const auto expect_plane = [&](const char* name, const Vec3& normal) {
    const CutPlane cut = named_cut(name, &path, seen_bone());
    EXPECT_NEAR(std::abs(cut.normal.normalized().dot(normal)), 1.0, 1e-12) << name;
    EXPECT_NEAR((middle_mm - cut.point_mm).dot(cut.normal), 0.0, 1e-9) << name;
  };
  expect_plane("axial", Vec3::UnitZ());
  expect_plane("sagittal", Vec3::UnitX());
  expect_plane("coronal", Vec3::UnitY());
  for (const char* name : {"path", "upright"}) {
    const CutPlane cut = named_cut(name, &path, seen_bone());
    EXPECT_NEAR(cut.normal.dot(path.direction()), 0.0, 1e-12) << name;
    EXPECT_NEAR((middle_mm - cut.point_mm).dot(cut.normal), 0.0, 1e-9) << name;
  }
  EXPECT_LT(named_cut("path", &path, seen_bone()).normal.z(), -0.9) << "what lies below is taken away";
  EXPECT_GT(named_cut("upright", &path, seen_bone()).normal.x(), 0.9) << "what lies beside it on the left";
  // Without a path: through the bone's middle.
  EXPECT_NEAR(named_cut("axial", nullptr, seen_bone()).point_mm.z(), kSeenBall.centre_mm.z(), 0.5);
}

TEST(NamedCut, IsRejectedWhereThereIsNone) {
  EXPECT_THAT([&] { named_cut("oblique", nullptr, seen_bone()); }, ThrowsMessage<Error>(HasSubstr("axial")));
  EXPECT_THAT([&] { named_cut("path", nullptr, seen_bone()); }, ThrowsMessage<Error>(HasSubstr("--plan")));
}

TEST(ViewOnto, LooksStraightOntoTheCut) {
  const DrillPath path = path_on_the_left();
  for (const char* name : {"axial", "sagittal", "coronal", "path", "upright"}) {
    const CutPlane cut = named_cut(name, &path, seen_bone());
    const PictureView view = view_onto(cut);
    EXPECT_NEAR(view.from.normalized().dot(cut.normal.normalized()), 1.0, 1e-12) << name;
  }
  // From the feet, with the patient's front up: the patient's left is on the right, as on an axial slice.
  const PictureView axial = view_onto(named_cut("axial", &path, seen_bone()));
  const Vec3 right = (-axial.from).cross(axial.up);
  EXPECT_GT(right.x(), 0.9);
}

}  // namespace
}  // namespace spinaltap

// Compiled with optimisation: long loops of its own.

#include "core/anatomy/landmarks.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "core/phantom/vertebra_ground_truth.h"
#include "tests/support/made_bone_shape.h"
#include "tests/support/random_vertebra.h"
#include "tests/support/release_only.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

/// The larger one of the two pedicles' errors.
struct LandmarkErrors {
  double axis_deg = 0.0, isthmus_mm = 0.0, width_mm = 0.0, height_mm = 0.0;

  void add(const PedicleLandmarks& found, const PedicleGroundTruth& ground_truth) {
    axis_deg = std::max(axis_deg, degrees_between(found.axis, ground_truth.axis));
    isthmus_mm = std::max(isthmus_mm, (found.isthmus_mm - ground_truth.isthmus_mm).norm());
    width_mm = std::max(width_mm, std::abs(found.width_mm - ground_truth.width_mm));
    height_mm = std::max(height_mm, std::abs(found.height_mm - ground_truth.height_mm));
  }
};

LandmarkErrors errors_of(const Landmarks& found, const Vertebra& vertebra) {
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
  LandmarkErrors errors;
  errors.add(found.left_pedicle, ground_truth.left);
  errors.add(found.right_pedicle, ground_truth.right);
  return errors;
}

/// What planning promises for phantoms; the method's own errors and those of noise are about half as large.
void expect_within_promise(const LandmarkErrors& errors, const std::string& what) {
  std::printf("%s: pedicle axis %.2f degrees, isthmus %.3f mm, width %.3f mm, height %.3f mm\n", what.c_str(),
              errors.axis_deg, errors.isthmus_mm, errors.width_mm, errors.height_mm);
  EXPECT_LE(errors.axis_deg, 2.0) << what;
  EXPECT_LE(errors.isthmus_mm, 0.5) << what;
  EXPECT_LE(errors.width_mm, 0.3) << what;
  EXPECT_LE(errors.height_mm, 0.5) << what;
}

std::string seed_name(std::uint64_t seed) { return "seed " + std::to_string(seed); }

void expect_no_warnings(const Landmarks& found) {
  for (const std::string& warning : found.warnings) ADD_FAILURE() << warning;
}

/// A few by default; SPINALTAP_PHANTOMS=50 takes fifty, as docs/landmarks.md does, and minutes.
std::uint64_t phantoms() {
  const char* const asked = std::getenv("SPINALTAP_PHANTOMS");
  return asked != nullptr ? static_cast<std::uint64_t>(std::max(1, std::atoi(asked))) : 3;
}

TEST(Landmarks, FindThePediclesOfRandomVertebrae) {
  RELEASE_ONLY();
  for (const double noise_mm : {0.0, 0.1}) {
    LandmarkErrors worst, sum;
    const std::uint64_t seeds = phantoms();
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const Vertebra vertebra(test::random_anatomy(seed));
      const Landmarks found = find_landmarks(test::shape_of(test::RoughSolid(vertebra, noise_mm, seed)));
      const LandmarkErrors errors = errors_of(found, vertebra);
      expect_within_promise(errors, seed_name(seed));
      expect_no_warnings(found);
      for (const auto member : {&LandmarkErrors::axis_deg, &LandmarkErrors::isthmus_mm, &LandmarkErrors::width_mm,
                                &LandmarkErrors::height_mm}) {
        worst.*member = std::max(worst.*member, errors.*member);
        sum.*member += errors.*member / static_cast<double>(seeds);
      }
    }
    const std::string noise = "noise " + std::to_string(noise_mm) + " mm";
    expect_within_promise(worst, noise + ", worst");
    expect_within_promise(sum, noise + ", mean of each vertebra's worse pedicle");
  }
}

/// Which of the landmarks a test compares, in the vertebra's own frame.
std::vector<Vec3> own_positions(const Landmarks& found, const Vertebra& vertebra) {
  std::vector<Vec3> positions;
  for (const Vec3& p_mm : {found.origin_mm, found.body.centre_mm, found.body.upper.centre_mm,
                           found.body.lower.centre_mm, found.left_pedicle.isthmus_mm, found.right_pedicle.isthmus_mm}) {
    positions.push_back(vertebra.to_own(p_mm));
  }
  return positions;
}

/// The shipped vertebra, whose frame, body and canal are known from its anatomy.
class LandmarksOfOneVertebra : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new Made;
    made_->found = find_landmarks(made_->bone);
  }
  static void TearDownTestSuite() {
    delete made_;
    made_ = nullptr;
  }

  struct Made {
    Vertebra vertebra;
    std::shared_ptr<const ScalarField> field = std::make_shared<test::GriddedField>(vertebra);
    BoneShape bone{field, vertebra.bounds_mm(), 0.3};
    Landmarks found;
  };
  static const Vertebra& vertebra() { return made_->vertebra; }
  static const Landmarks& found() { return made_->found; }
  static const BoneShape& bone() { return made_->bone; }

  /// The message with which landmarks of what a plane leaves are rejected.
  static std::string rejection_of_cut(const Vec3& point_mm, const Vec3& normal) {
    const BoneShape part(std::make_shared<test::CutField>(made_->field, point_mm, normal), vertebra().bounds_mm(), 0.3);
    try {
      (void)find_landmarks(part);
    } catch (const Error& error) {
      std::printf("%s\n", error.what());
      return error.what();
    }
    return "";
  }
  static Landmarks found_of_cut(const Vec3& point_mm, const Vec3& normal) {
    return find_landmarks(
        BoneShape(std::make_shared<test::CutField>(made_->field, point_mm, normal), vertebra().bounds_mm(), 0.3));
  }

  static Made* made_;
};
LandmarksOfOneVertebra::Made* LandmarksOfOneVertebra::made_ = nullptr;

SLOW_TESTS("LandmarksOfOneVertebra.*");

TEST_F(LandmarksOfOneVertebra, HaveItsAxesAndMidsagittalPlane) {
  EXPECT_LE(degrees_between(found().left(), Vec3::UnitX()), 0.1);
  EXPECT_LE(degrees_between(found().superior(), Vec3::UnitZ()), 0.5);
  EXPECT_LE(std::abs(found().origin_mm.x()), 0.1);
  EXPECT_NEAR(found().axes.determinant(), 1.0, 1e-12);
  expect_no_warnings(found());
}

TEST_F(LandmarksOfOneVertebra, HaveTheSizesOfItsBodyAndCanal) {
  const VertebraAnatomy anatomy;
  const Landmarks::Body& body = found().body;
  // At its waist, the body's width is less by that of the waist, by the ratio of width to depth on either side.
  const double waist_mm = 2.0 * anatomy.body.waist_mm;
  EXPECT_NEAR(body.width_mm, anatomy.body.width_mm - waist_mm * anatomy.body.width_mm / anatomy.body.depth_mm, 0.5);
  // The canal does not reach the waist's back.
  EXPECT_NEAR(body.depth_mm, anatomy.body.depth_mm - waist_mm, 0.3);
  // Between the endplates' planes: below the rims, above the hollows.
  EXPECT_LE(body.height_mm, anatomy.body.height_mm);
  EXPECT_GE(body.height_mm, anatomy.body.height_mm - anatomy.body.superior_hollow_mm - anatomy.body.inferior_hollow_mm);
  EXPECT_LE(std::abs(body.centre_mm.x()), 0.2);
  // The hollows are deepest ahead of where the kidney's shape has its middle, which tilts planes through them.
  EXPECT_LE(degrees_between(body.upper.normal, Vec3::UnitZ()), 2.0);
  EXPECT_LE(degrees_between(body.lower.normal, -Vec3::UnitZ()), 2.0);

  // The canal is a prism along z; its walls are the pedicles.
  const Landmarks::Canal& canal = found().canal;
  EXPECT_LE(degrees_between(canal.axis, Vec3::UnitZ()), 1.0);
  const VertebraAnatomy::Pedicle& pedicle = anatomy.pedicle;
  const double across = std::cos(pedicle.convergence_deg * std::numbers::pi / 180.0);
  const double between_mm = 2.0 * (pedicle.isthmus_mm.x() - 0.5 * pedicle.width_mm / across);
  EXPECT_NEAR(canal.width_mm, between_mm, 1.0);
  EXPECT_NEAR(canal.depth_mm, anatomy.canal.back_mm - anatomy.canal.front_mm, 2.0);
}

TEST_F(LandmarksOfOneVertebra, TellTheCanalsWallFromTheOutside) {
  const VertebraAnatomy anatomy;
  ASSERT_EQ(found().is_canal_wall.size(), bone().points_mm().size());
  const Vec3 isthmus = anatomy.pedicle.isthmus_mm;
  std::size_t inner = 0, outer = 0, back = 0, lamina = 0;
  for (std::size_t n = 0; n < bone().points_mm().size(); ++n) {
    const Vec3 p = bone().points_mm()[n], side(std::abs(p.x()), p.y(), p.z());
    const Vec3 normal = bone().normals()[n];
    const double inward = p.x() > 0.0 ? -normal.x() : normal.x();
    const bool is_wall = found().is_canal_wall[n] != 0;
    const bool at_isthmus = std::abs(side.y() - isthmus.y()) < 2.0 && std::abs(side.z() - isthmus.z()) < 5.0;
    if (at_isthmus && inward > 0.6 && side.x() < isthmus.x()) {
      EXPECT_TRUE(is_wall) << "inner side of a pedicle at " << p.transpose();
      ++inner;
    }
    if (at_isthmus && inward < -0.6 && side.x() > isthmus.x()) {
      EXPECT_FALSE(is_wall) << "outer side of a pedicle at " << p.transpose();
      ++outer;
    }
    if (side.x() < 7.0 && std::abs(p.z()) < 8.0 && normal.y() > 0.9 && p.y() < 17.0) {
      EXPECT_TRUE(is_wall) << "back of the body at " << p.transpose();
      ++back;
    }
    if (side.x() < 7.0 && p.z() < -2.0 && p.z() > -12.0 && normal.y() < -0.5 && p.y() > 24.0 && p.y() < 32.0) {
      EXPECT_TRUE(is_wall) << "front of a lamina at " << p.transpose();
      ++lamina;
    }
    if (p.y() < 12.0 || side.x() > 20.0 || p.y() > 40.0) {
      EXPECT_FALSE(is_wall) << "outside at " << p.transpose();
    }
  }
  for (const std::size_t count : {inner, outer, back, lamina}) EXPECT_GT(count, 100U);
}

TEST_F(LandmarksOfOneVertebra, AreTheSameBitForBitOnOneThread) {
  Landmarks alone;
  tbb::task_arena(1).execute([&] { alone = find_landmarks(bone()); });
  EXPECT_EQ(alone.axes, found().axes);
  EXPECT_EQ(alone.origin_mm, found().origin_mm);
  EXPECT_EQ(alone.left_pedicle.axis, found().left_pedicle.axis);
  EXPECT_EQ(alone.left_pedicle.width_mm, found().left_pedicle.width_mm);
  EXPECT_EQ(alone.right_pedicle.isthmus_mm, found().right_pedicle.isthmus_mm);
  EXPECT_EQ(alone.canal.axis, found().canal.axis);
  EXPECT_EQ(alone.body.upper.normal, found().body.upper.normal);
  EXPECT_EQ(alone.is_canal_wall, found().is_canal_wall);
}

TEST_F(LandmarksOfOneVertebra, MoveAndTurnWithIt) {
  const std::vector<Vec3> expected = own_positions(found(), vertebra());
  for (const Vec3& turn_deg : {Vec3(20, 0, 0), Vec3(0, 20, 0), Vec3(0, 0, 20), Vec3(-20, 0, 0), Vec3(0, 0, -20)}) {
    VertebraAnatomy anatomy;
    anatomy.placement.rotation_deg = turn_deg;
    anatomy.placement.position_mm = Vec3(-123.4, 56.7, 890.1);
    const Vertebra turned(anatomy);
    const Landmarks landmarks = find_landmarks(test::shape_of(turned));
    std::ostringstream name;
    name << "turned by " << turn_deg.transpose() << " degrees";
    expect_within_promise(errors_of(landmarks, turned), name.str());
    const std::vector<Vec3> positions = own_positions(landmarks, turned);
    // The canal's and endplates' windows lie on the lattice otherwise; 0.5 mm is a voxel of it.
    for (std::size_t n = 0; n < expected.size(); ++n) {
      EXPECT_LE((positions[n] - expected[n]).norm(), 0.5) << name.str() << ", position " << n;
    }
    EXPECT_LE(degrees_between(landmarks.superior(), turned.rotation().col(2)), 0.5) << name.str();
    EXPECT_LE(degrees_between(landmarks.left(), turned.rotation().col(0)), 0.1) << name.str();
    expect_no_warnings(landmarks);
  }
}

TEST_F(LandmarksOfOneVertebra, DoNotDependOnTheCropAroundIt) {
  const Box3 box_mm = vertebra().bounds_mm();
  const Box3 crop_mm(box_mm.min() - Vec3(13.1, 0.3, 7.7), box_mm.max() + Vec3(0.2, 21.9, 0.1));
  const Landmarks landmarks = find_landmarks(BoneShape(made_->field, crop_mm, 0.3));
  const std::vector<Vec3> expected = own_positions(found(), vertebra()),
                          positions = own_positions(landmarks, vertebra());
  for (std::size_t n = 0; n < expected.size(); ++n) EXPECT_LE((positions[n] - expected[n]).norm(), 0.1) << n;
}

TEST_F(LandmarksOfOneVertebra, AreFoundWithAWarningWhereOnlyAProcessIsCutOff) {
  for (const auto& [point_mm, normal, side] :
       {std::tuple(Vec3(0, 47, 0), Vec3(0, 1, 0), "back"), std::tuple(Vec3(28, 0, 0), Vec3(1, 0, 0), "left")}) {
    const Landmarks landmarks = found_of_cut(point_mm, normal);
    expect_within_promise(errors_of(landmarks, vertebra()), std::string("cut at the ") + side);
    ASSERT_EQ(landmarks.warnings.size(), 1U);
    EXPECT_NE(landmarks.warnings[0].find(side), std::string::npos) << landmarks.warnings[0];
  }
}

TEST_F(LandmarksOfOneVertebra, AreRejectedForHalfOfItAndTheMissingSideIsNamed) {
  const Vec3 middle = Vec3::Zero();
  EXPECT_NE(rejection_of_cut(middle, Vec3(1, 0, 0)).find("patient's left"), std::string::npos);
  EXPECT_NE(rejection_of_cut(middle, Vec3(-1, 0, 0)).find("patient's right"), std::string::npos);
  EXPECT_NE(rejection_of_cut(middle, Vec3(0, 0, 1)).find("patient's top"), std::string::npos);
  EXPECT_NE(rejection_of_cut(middle, Vec3(0, 0, -1)).find("patient's bottom"), std::string::npos);
  EXPECT_NE(rejection_of_cut(middle, Vec3(0, -1, 0)).find("patient's front"), std::string::npos);
  // The body and pedicles without the arch.
  EXPECT_NE(rejection_of_cut(Vec3(0, 22, 0), Vec3(0, 1, 0)).find("no canal"), std::string::npos);
  // The arch without the body.
  EXPECT_NE(rejection_of_cut(Vec3(0, 19, 0), Vec3(0, -1, 0)), "");
  EXPECT_NE(rejection_of_cut(middle, Vec3(1, 0.2, 0.3)).find("patient's left"), std::string::npos);
}

}  // namespace
}  // namespace spinaltap

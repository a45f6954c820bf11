#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/slice_frame.h"
#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

const Box3 kCrop(Vec3(-40, -30, 100), Vec3(45, 50, 140));

/// A random path in the crop's middle.
DrillPath random_path(std::uint64_t seed) {
  const auto number = [&](std::uint64_t i) { return 2.0 * random_uniform(seed, i) - 1.0; };
  DrillPath path;
  path.entry_mm = Vec3(10 * number(0), 20 + 10 * number(1), 120 + 10 * number(2));
  path.target_mm = Vec3(10 * number(3), -10 + 10 * number(4), 120 + 10 * number(5));
  return path;
}

void expect_right_handed(const SliceFrame& frame) {
  EXPECT_NEAR(frame.right.norm(), 1.0, 1e-12);
  EXPECT_NEAR(frame.down.norm(), 1.0, 1e-12);
  EXPECT_NEAR(frame.right.dot(frame.down), 0.0, 1e-12);
}

TEST(SliceFrame, MapsThereAndBack) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const DrillPath path = random_path(seed);
    for (const SliceFrame& frame :
         {plane_frame(Plane::kAxial, path.entry_mm, kCrop), plane_frame(Plane::kCoronal, path.entry_mm, kCrop),
          plane_frame(Plane::kSagittal, path.entry_mm, kCrop), path_frame(path, kCrop)}) {
      expect_right_handed(frame);
      // 1e-9 mm: rounding of values near 100.
      EXPECT_LT((frame.to_patient(frame.to_pixel(path.target_mm)) - path.target_mm).norm(), 1e-9) << "seed " << seed;
      EXPECT_LT((frame.to_pixel(frame.to_patient(Vec3(7, 9, 11))) - Vec3(7, 9, 11)).norm(), 1e-8) << "seed " << seed;
    }
  }
}

TEST(SliceFrame, CoversTheCropWithLessThanAPixelToSpare) {
  const SliceFrame frame = plane_frame(Plane::kAxial, {0, 0, 120}, kCrop, 0.2);
  EXPECT_EQ(frame.width, 425);   // 85 mm
  EXPECT_EQ(frame.height, 400);  // 80 mm
  const Vec3 corner = frame.to_pixel(Vec3(-40, -30, 120));
  EXPECT_NEAR(corner.x(), -0.5, 1e-9);  // the first pixel's outer edge
  EXPECT_NEAR(corner.y(), -0.5, 1e-9);
  EXPECT_NEAR(frame.origin_mm.z(), 120.0, 1e-12);
}

TEST(SliceFrame, HoldsTheWholePathAndIsTheClosestToAxial) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const DrillPath path = random_path(seed);
    const SliceFrame frame = path_frame(path, kCrop);
    EXPECT_NEAR(frame.to_pixel(path.entry_mm).z(), 0.0, 1e-8) << "seed " << seed;
    EXPECT_NEAR(frame.to_pixel(path.target_mm).z(), 0.0, 1e-8) << "seed " << seed;
    // The tilt of the steepest line in the plane cannot be less than the path's own, and need not be more.
    EXPECT_NEAR(std::abs(frame.into().z()), std::sqrt(1.0 - std::pow(path.direction().z(), 2)), 1e-9)
        << "seed " << seed;
    EXPECT_GT(frame.right.x(), 0.0) << "the patient's left is on the right, seed " << seed;
    EXPECT_GT(frame.down.y(), 0.0) << "posterior is below, seed " << seed;
  }
}

TEST(SliceFrame, ShowsAPathAlongTheBodyInTheSagittalPlane) {
  DrillPath path;
  path.entry_mm = {1, 2, 130};
  path.target_mm = {1, 2, 110};
  const SliceFrame frame = path_frame(path, kCrop);
  EXPECT_TRUE(frame.right.isApprox(Vec3::UnitY(), 1e-12));
  EXPECT_TRUE(frame.down.isApprox(-Vec3::UnitZ(), 1e-12));
}

TEST(SliceFrame, GrowsEvenlyAndStaysInItsPlane) {
  const SliceFrame frame = plane_frame(Plane::kCoronal, {0, 7, 120}, kCrop, 0.5);
  const SliceFrame grown = grown_to(frame, frame.width + 10, frame.height - 5);
  EXPECT_EQ(grown.width, frame.width + 10);
  EXPECT_EQ(grown.height, frame.height);
  const Vec3 p_patient(3, 7, 111);
  EXPECT_TRUE((grown.to_pixel(p_patient) - frame.to_pixel(p_patient)).isApprox(Vec3(5, 0, 0), 1e-9));
}

TEST(SliceFrame, NamesDirectionsInThePatient) {
  EXPECT_EQ(orientation_letters(Vec3::UnitX()), "L");
  EXPECT_EQ(orientation_letters(-Vec3::UnitX()), "R");
  EXPECT_EQ(orientation_letters(Vec3::UnitY()), "P");
  EXPECT_EQ(orientation_letters(-Vec3::UnitY()), "A");
  EXPECT_EQ(orientation_letters(Vec3::UnitZ()), "S");
  EXPECT_EQ(orientation_letters(-Vec3::UnitZ()), "I");
  EXPECT_EQ(orientation_letters(Vec3(0.3, -0.95, 0.0)), "A");
  EXPECT_EQ(orientation_letters(Vec3(0.6, -0.8, 0.0)), "AL");
}

TEST(SliceFrame, RejectsCropsThatMakeNoPicture) {
  EXPECT_THROW(plane_frame(Plane::kAxial, Vec3::Zero(), Box3()), Error);
  EXPECT_THROW(plane_frame(Plane::kAxial, Vec3::Zero(), kCrop, 0.0), Error);
  EXPECT_THROW(plane_frame(Plane::kAxial, Vec3::Zero(), kCrop, 0.001), Error);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(plane_frame(Plane::kAxial, Vec3::Zero(), Box3(Vec3(0, 0, 0), Vec3(1, nan, 1))), Error);
}

struct Orientation {
  const char* name;
  Mat3 directions;
};

/// CTs as scanners stack them: axial slices, sagittal slices, and slices turned about all axes.
std::vector<Orientation> orientations() {
  Mat3 sagittal;
  sagittal.col(0) = Vec3::UnitY();
  sagittal.col(1) = -Vec3::UnitZ();
  sagittal.col(2) = -Vec3::UnitX();
  const Mat3 oblique = (Eigen::AngleAxisd(0.4, Vec3::UnitX()) * Eigen::AngleAxisd(-0.3, Vec3::UnitY()) *
                        Eigen::AngleAxisd(0.7, Vec3::UnitZ()))
                           .toRotationMatrix();
  return {{"axial", Mat3::Identity()}, {"sagittal", sagittal}, {"oblique", oblique}};
}

/// -1000 HU but for one voxel of 1,400 HU.
CtVolume one_bright_voxel(const Mat3& directions, const std::array<int, 3>& index) {
  GridGeometry grid;
  grid.size = {60, 50, 40};
  grid.spacing_mm = {0.5, 0.6, 0.8};
  grid.origin_mm = {-14.0, -11.0, 30.0};
  grid.directions = directions;
  std::vector<std::int16_t> hu(grid.voxel_count(), -1000);
  hu[grid.offset(index[0], index[1], index[2])] = 1400;
  return make_ct_volume(grid, std::move(hu));
}

/// Column and row of the brightest pixel.
Eigen::Vector2i brightest(const Image& image) {
  const auto top = std::max_element(image.rgb.begin(), image.rgb.end());
  const auto pixel = static_cast<int>((top - image.rgb.begin()) / 3);
  return {pixel % image.width, pixel / image.width};
}

std::uint8_t grey_at(const Image& image, const Eigen::Vector2i& pixel) {
  return image.rgb[3 * static_cast<std::size_t>(pixel.y() * image.width + pixel.x())];
}

TEST(CtSlice, ShowsABrightVoxelWhereTheMappingSaysInAllPlanesAndOrientations) {
  for (const Orientation& orientation : orientations()) {
    const CtVolume ct = one_bright_voxel(orientation.directions, {21, 17, 23});
    const Vec3 p_patient = ct.geometry.to_patient(Vec3(21, 17, 23));
    const Box3 crop(p_patient - Vec3(6.0, 7.0, 8.0), p_patient + Vec3(9.0, 8.0, 5.0));
    for (const Plane plane : {Plane::kAxial, Plane::kCoronal, Plane::kSagittal}) {
      const CtSlice slice = ct_slice(ct, plane_frame(plane, p_patient, crop, 0.1));
      const Vec3 p_pixel = slice.frame.to_pixel(p_patient);
      EXPECT_NEAR(p_pixel.z(), 0.0, 1e-9);
      const Eigen::Vector2i found = brightest(slice.image);
      // The peak may lie between two pixels.
      EXPECT_LE((found.cast<double>() - p_pixel.head<2>()).cwiseAbs().maxCoeff(), 0.5 + 1e-9) << orientation.name;
      EXPECT_GT(grey_at(slice.image, found), 128) << orientation.name;
    }
  }
}

TEST(CtSlice, LooksFromTheFeetTheFrontAndTheLeft) {
  const Box3 crop(Vec3(-10, -10, -10), Vec3(10, 10, 10));
  const Vec3 middle = Vec3::Zero();
  const auto moved = [&](Plane plane, const Vec3& step) {
    const SliceFrame frame = plane_frame(plane, middle, crop, 0.5);
    return Vec3(frame.pixel_mm * (frame.to_pixel(step) - frame.to_pixel(middle)));
  };
  const Vec3 left = Vec3::UnitX();
  const Vec3 posterior = Vec3::UnitY();
  const Vec3 superior = Vec3::UnitZ();
  const double tolerance = 1e-12;  // rounding of values near 10
  // Right, down and away from the viewer.
  EXPECT_TRUE(moved(Plane::kAxial, left).isApprox(Vec3(1, 0, 0), tolerance));
  EXPECT_TRUE(moved(Plane::kAxial, posterior).isApprox(Vec3(0, 1, 0), tolerance));
  EXPECT_TRUE(moved(Plane::kAxial, superior).isApprox(Vec3(0, 0, 1), tolerance));
  EXPECT_TRUE(moved(Plane::kCoronal, left).isApprox(Vec3(1, 0, 0), tolerance));
  EXPECT_TRUE(moved(Plane::kCoronal, superior).isApprox(Vec3(0, -1, 0), tolerance));
  EXPECT_TRUE(moved(Plane::kCoronal, posterior).isApprox(Vec3(0, 0, 1), tolerance));
  EXPECT_TRUE(moved(Plane::kSagittal, posterior).isApprox(Vec3(1, 0, 0), tolerance));
  EXPECT_TRUE(moved(Plane::kSagittal, superior).isApprox(Vec3(0, -1, 0), tolerance));
  EXPECT_TRUE(moved(Plane::kSagittal, left).isApprox(Vec3(0, 0, -1), tolerance));
}

TEST(CtSlice, MapsTheWindowToBlackAndWhite) {
  const auto grey_of = [](std::int16_t hu) {
    GridGeometry grid;
    grid.size = {4, 4, 4};
    const CtVolume ct = make_ct_volume(grid, std::vector<std::int16_t>(64, hu));
    const Box3 crop(Vec3(1, 1, 1), Vec3(2, 2, 2));
    return static_cast<int>(ct_slice(ct, plane_frame(Plane::kAxial, {1.5, 1.5, 1.5}, crop)).image.rgb[0]);
  };
  EXPECT_EQ(grey_of(-400), 0);
  EXPECT_EQ(grey_of(1400), 255);
  EXPECT_EQ(grey_of(500), 128);  // 127.5 rounds up
  EXPECT_EQ(grey_of(-1024), 0);
  EXPECT_EQ(grey_of(3000), 255);
}

TEST(CtSlice, IsBlackOutsideTheCt) {
  GridGeometry grid;
  grid.size = {4, 4, 4};
  const CtVolume ct = make_ct_volume(grid, std::vector<std::int16_t>(64, 1400));
  const CtSlice slice = ct_slice(ct, plane_frame(Plane::kAxial, {1, 1, 1}, Box3(Vec3(-5, -5, 0), Vec3(8, 8, 3)), 1.0));
  EXPECT_EQ(slice.image.rgb.front(), 0);
  const auto white = std::count(slice.image.rgb.begin(), slice.image.rgb.end(), 255);
  // Pixel centres at -4.5, -3.5, ... meet the voxel centres' span 0 to 3 at 0.5, 1.5 and 2.5.
  EXPECT_EQ(white, 3 * 3 * 3);
}

TEST(CtSlice, RejectsAWindowWithoutWidth) {
  GridGeometry grid;
  grid.size = {2, 2, 2};
  const CtVolume ct = make_ct_volume(grid, std::vector<std::int16_t>(8));
  const SliceFrame frame = plane_frame(Plane::kAxial, {0, 0, 0}, Box3(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  EXPECT_THROW(ct_slice(ct, frame, {.width_hu = 0.0}), Error);
  EXPECT_THROW(ct_slice(ct, frame, {.width_hu = std::numeric_limits<double>::quiet_NaN()}), Error);
}

}  // namespace

}  // namespace spinaltap

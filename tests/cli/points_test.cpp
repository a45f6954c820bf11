// Surface points from the command line: what the file holds, read back here by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>

#include "core/base/staged_output.h"
#include "core/ct/dicom_write.h"
#include "core/ct/label_map.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::run_program;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kSide = 48;
constexpr double kVoxelMm = 0.5;
constexpr double kScannedRadiusMm = 8.0;
const Vec3 kScannedCentreMm(12.1, 11.7, 12.3);

/// A ball of 700 HU in water with its label map, 2.
class Points : public testing::Test {
 protected:
  Points() {
    GridGeometry geometry;
    geometry.size = {kSide, kSide, kSide};
    geometry.spacing_mm = Vec3::Constant(kVoxelMm);
    std::vector<std::int16_t> hu;
    BoneMask mask{geometry, {}};
    for (int k = 0; k < kSide; ++k) {
      for (int j = 0; j < kSide; ++j) {
        for (int i = 0; i < kSide; ++i) {
          const double depth_mm = kScannedRadiusMm - (geometry.to_patient(Vec3(i, j, k)) - kScannedCentreMm).norm();
          hu.push_back(static_cast<std::int16_t>(std::lround(350.0 * std::erfc(-depth_mm / (0.4 * std::sqrt(2.0))))));
          mask.inside.push_back(depth_mm > 0.0 ? 1 : 0);
        }
      }
    }
    std::filesystem::create_directory(folder_.path() / "ct");
    write_dicom(make_ct_volume(geometry, std::move(hu)), folder_.path() / "ct");
    write_whole_file(folder_.path() / "ball.nrrd", encode_label_map(mask, 2, "ball.nrrd"));
  }

  /// The seven floats of each point.
  std::vector<std::array<float, 7>> read_points() const {
    const std::string bytes = read_whole_file(folder_.path() / "points.ply");
    const std::size_t head = bytes.find("end_header\n") + 11;
    EXPECT_THAT(bytes.substr(0, head), HasSubstr("property float value"));
    std::vector<std::array<float, 7>> points((bytes.size() - head) / sizeof(std::array<float, 7>));
    std::memcpy(points.data(), bytes.data() + head, points.size() * sizeof points[0]);
    EXPECT_THAT(bytes.substr(0, head), HasSubstr("element vertex " + std::to_string(points.size()) + "\n"));
    return points;
  }

  test::TemporaryFolder folder_;
};

TEST_F(Points, HaveNormalsAndTheDistanceFromTheSurfaceAsValue) {
  const test::ProgramRun run = run_program("points ct --labels ball.nrrd --label 2", folder_.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto points = read_points();
  EXPECT_THAT(run.output, HasSubstr("off-surface points"));
  std::size_t on_surface = 0;
  double mean_mm = 0.0;
  for (const auto& [x, y, z, nx, ny, nz, value] : points) {
    const Vec3 out = Vec3(x, y, z) - kScannedCentreMm;
    on_surface += value == 0.0F ? 1U : 0U;
    const double miss_mm = std::abs(out.norm() - kScannedRadiusMm - static_cast<double>(value));
    ASSERT_LT(miss_mm, 0.15);  // where the mask's terraces lean a normal, as in extract_surface()'s own test
    mean_mm += miss_mm / static_cast<double>(points.size());
    ASSERT_GT(out.normalized().dot(Vec3(nx, ny, nz)), 0.97);
  }
  EXPECT_LT(mean_mm, 0.02);
  EXPECT_GT(on_surface, 3000U);
  EXPECT_GT(points.size(), on_surface * 295 / 100);  // one off-surface point on each side, nearly everywhere
}

TEST_F(Points, OfPixelsLieOnTheVoxels) {
  const test::ProgramRun run = run_program("points ct --labels ball.nrrd --label 2 --method pixels", folder_.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  for (const auto& point : read_points()) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double index = static_cast<double>(point[axis]) / kVoxelMm;
      ASSERT_NEAR(index, std::round(index), 1e-4);
    }
    ASSERT_TRUE(point[6] == 0.0F || std::abs(point[6]) == 0.5F);
  }
}

TEST_F(Points, AreRejectedInOneLineAndLeaveNoFile) {
  for (const char* arguments : {"--method splines", "--off-surface 0", "--off-surface nan --label 2 --labels ball.nrrd",
                                "--label 3 --labels ball.nrrd", "--labels missing.nrrd"}) {
    const test::ProgramRun run = run_program(std::string("points ct ") + arguments, folder_.path());
    EXPECT_NE(run.exit_code, 0) << arguments;
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "points.ply"));
  }
  // A disk that is full after 8 kB.
  const test::ProgramRun full = run_program("points ct --labels ball.nrrd --label 2", folder_.path(), "ulimit -f 8;");
  EXPECT_NE(full.exit_code, 0);
  EXPECT_THAT(full.errors, HasSubstr("cannot write"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "points.ply"));
}

}  // namespace
}  // namespace spinaltap

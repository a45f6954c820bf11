// A file of format 225, which OpenVDB 13.0 wrote (Debian's, in its own default compression, then gzip -9n): a ball as a
// level set, with metadata that are a half float; a grid of numbers where it is; and a grid of half floats, which is
// new in that format.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "tests/support/gunzip.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"
#include "vdb/detail/vdb_file.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::ThrowsMessage;

class NewerVdb : public testing::Test {
 protected:
  static constexpr std::size_t kBytes = 38357;
  static constexpr std::size_t kFormatAt = 8;

  static std::string bytes() {
    return test::gunzip(std::string(test::kSourceFolder) + "/tests/unit/vdb/grid/openvdb_13.vdb.gz");
  }
  std::filesystem::path file(const std::string& bytes) const {
    const std::filesystem::path path = folder_.path() / "newer.vdb";
    std::filesystem::remove(path);
    write_whole_file(path, bytes);
    return path;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(NewerVdb, OfFormat225IsReadWithoutAWord) {
  const std::string whole = bytes();
  ASSERT_EQ(whole[kFormatAt], '\xe1');
  testing::internal::CaptureStderr();
  const BoneModel bone = read_bone(file(whole));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
  // Half-way between voxels, and where distances end.
  const Vec3 centre_mm(21.5, 22.5, 23.5);
  const std::array<Vec3, 3> points_mm{centre_mm, centre_mm + Vec3(1.25, 0, 0), centre_mm + Vec3(0, 0, 2.5)};
  std::array<float, 3> distance_mm{};
  std::array<float, 3> hu{};
  bone.sample(points_mm, distance_mm, hu);
  EXPECT_FLOAT_EQ(distance_mm[0], -1.5F);
  EXPECT_FLOAT_EQ(distance_mm[1], -0.75F);
  EXPECT_FLOAT_EQ(distance_mm[2], 0.5F);
  // 100 and the place along x, in voxels.
  EXPECT_FLOAT_EQ(hu[1], 145.5F);
  EXPECT_FLOAT_EQ(hu[2], 143.0F);
}

TEST_F(NewerVdb, HasItsGridOfHalfFloatsRejectedByItsType) {
  detail::VdbFile newer(file(bytes()));
  EXPECT_THAT([&] { newer.read_floats("density"); }, ThrowsMessage<Error>(HasSubstr("Tree_half_5_4_3")));
}

TEST_F(NewerVdb, IsRejectedOrReadWhateverByteIsAnother) {
  const std::string whole = bytes();
  int rejected = 0;
  for (std::size_t at = 0; at < whole.size(); at += at < 1200 ? 3 : 499) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(~damaged[at]);
    try {
      read_bone(file(damaged));
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("newer.vdb"));
      ++rejected;
    }
  }
  EXPECT_GT(rejected, 20);
}

TEST_F(NewerVdb, OfALaterFormatOrAnOlderOneIsToldWhatToSaveItWith) {
  std::string later = bytes();
  later[kFormatAt] = '\xe2';
  EXPECT_THAT([&] { read_bone(file(later)); },
              ThrowsMessage<Error>(AllOf(HasSubstr("222 to 225, found 226"), HasSubstr("newer than 13"))));
  std::string older = bytes();
  older[kFormatAt] = '\xdd';
  EXPECT_THAT([&] { read_bone(file(older)); },
              ThrowsMessage<Error>(
                  AllOf(HasSubstr("found 221"), HasSubstr("OpenVDB 2 or later"), Not(HasSubstr("newer than")))));
}

}  // namespace
}  // namespace spinaltap

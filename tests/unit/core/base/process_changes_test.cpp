#include "core/base/process_changes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/error.h"
#include "core/ct/read_ct.h"
#include "tests/support/hostile_cts.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

/// What the process says on its standard error while it reads a picture that a decoder within GDCM complains about.
std::string words_about_a_damaged_picture() {
  const std::vector<test::HostileCt> all = test::hostile_cts();
  const auto damaged = std::ranges::find(all, "JpegLsCutShortWithinACode", &test::HostileCt::name);
  const test::TemporaryFolder folder;
  testing::internal::CaptureStderr();
  EXPECT_THROW(static_cast<void>(read_ct(damaged->make(folder.path()))), Error);
  return testing::internal::GetCapturedStderr();
}

TEST(ProcessChanges, LeaveTheStandardErrorAloneUntilAProgramAllowsIt) {
  EXPECT_THAT(words_about_a_damaged_picture(), testing::Not(testing::IsEmpty()));
  allow_process_changes({.silences_decoders = true});
  EXPECT_THAT(words_about_a_damaged_picture(), testing::IsEmpty());
  allow_process_changes({});
}

}  // namespace
}  // namespace spinaltap

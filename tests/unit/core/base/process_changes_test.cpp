#include "core/base/process_changes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/ct/read_ct.h"
#include "tests/support/hostile_cts.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

/// What the process says on its standard error while it reads pictures that decoders within GDCM complain about.
std::string words_about_damaged_pictures() {
  testing::internal::CaptureStderr();
  for (const test::HostileCt& damaged : test::hostile_cts()) {
    const test::TemporaryFolder folder;
    EXPECT_THROW(static_cast<void>(read_ct(damaged.make(folder.path()))), Error) << damaged.name;
  }
  return testing::internal::GetCapturedStderr();
}

TEST(ProcessChanges, LeaveTheStandardErrorAloneUntilAProgramAllowsIt) {
  EXPECT_THAT(words_about_damaged_pictures(), testing::Not(testing::IsEmpty()));
  allow_process_changes({.silences_decoders = true});
  EXPECT_THAT(words_about_damaged_pictures(), testing::IsEmpty());
  allow_process_changes({});
}

}  // namespace
}  // namespace spinaltap

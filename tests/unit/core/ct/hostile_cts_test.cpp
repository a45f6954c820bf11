// What is no valid CT is rejected with a word. tests/cli measures time and memory of the same files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/ct/read_ct.h"
#include "tests/support/error_of.h"
#include "tests/support/hostile_cts.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

class HostileCtOf : public testing::TestWithParam<test::HostileCt> {};

TEST_P(HostileCtOf, IsRejectedWithAWord) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = GetParam().make(folder.path());
  for (const bool resample : {false, true}) {
    const std::string message = test::error_of([&] { read_ct(path, {.series = "", .resample = resample}); });
    EXPECT_THAT(message, testing::HasSubstr(GetParam().word)) << "resample " << resample;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(Every, HostileCtOf, testing::ValuesIn(test::hostile_cts()),
                         [](const auto& hostile) { return hostile.param.name; });

}  // namespace
}  // namespace spinaltap

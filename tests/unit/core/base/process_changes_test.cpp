#include "core/base/process_changes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <fstream>

#include "core/base/error.h"
#include "core/ct/read_ct.h"
#include "tests/support/made_series.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

/// What the process says on its standard error while it reads every kind of series with damage in its pixels, which
/// decoders within GDCM complain about.
std::string words_about_damaged_pictures() {
  testing::internal::CaptureStderr();
  for (const test::SeriesRecipe& recipe : test::every_kind_of_series()) {
    const test::TemporaryFolder folder;
    for (const test::MadeSeries::File& file : test::make_series(recipe).files) {
      std::string bytes = file.bytes;
      for (std::size_t n = 1; n < 12; ++n) bytes[bytes.size() - 17 * n] ^= '\x55';
      std::ofstream(folder.path() / file.name, std::ios::binary) << bytes;
    }
    try {
      static_cast<void>(read_ct(folder.path()));
    } catch (const Error&) {  // where the damage shows
    }
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

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Validate, HoldsLawsAgainstEveryMeasurementAndIsTheSameOnAnyThreads) {
  const test::TemporaryFolder folder;
  const test::ProgramRun run =
      test::run_program("validate --csv v.csv --plot v.svg --json v.json --threads 1", folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, AllOf(HasSubstr("macavelia2012"), HasSubstr("powers_cited"), HasSubstr("median factor")));
  // What no law speaks of is told with its reason.
  EXPECT_THAT(run.output, AllOf(HasSubstr("an awl does not cut"), HasSubstr("its density is not stated")));
  const Json figures = read_json(folder.path() / "v.json");
  for (const char* law : {"power", "mechanistic"}) {
    const Json& one = figures.at("laws").at(law);
    std::size_t inside = 0;
    for (const Json& figure : one.at("figures")) inside += figure.at("inside").get<bool>() ? 1U : 0U;
    EXPECT_NEAR(one.at("inside_share").get<double>(),
                static_cast<double>(inside) / static_cast<double>(one.at("figures").size()), 1e-12);
  }
  EXPECT_THAT(read_whole_file(folder.path() / "v.csv"), StartsWith("law,source,bone,quantity,unit,measured,"));
  EXPECT_THAT(read_whole_file(folder.path() / "v.svg"), StartsWith("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  const test::ProgramRun again = test::run_program("validate --csv w.csv --threads 2", folder.path());
  ASSERT_EQ(again.exit_code, 0) << again.errors;
  EXPECT_EQ(read_whole_file(folder.path() / "w.csv"), read_whole_file(folder.path() / "v.csv"));
}

TEST(Validate, NamesTheFolderWithoutMeasurements) {
  const test::TemporaryFolder folder;
  const test::ProgramRun run = test::run_program("validate --measurements none", folder.path());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("none"));
}

}  // namespace
}  // namespace spinaltap

// What is no valid CT is rejected with one line, within a second and 200 MB, measured on the program itself.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "core/base/staged_output.h"
#include "tests/support/hostile_cts.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

struct MeasuredRun {
  int exit_code = -1;
  std::string errors;
  double seconds = 0.0;
  double peak_mb = 0.0;
};

/// `spinaltap info PATH --resample`, in a process of its own.
MeasuredRun run_info(const std::filesystem::path& path, const std::filesystem::path& errors) {
  const auto begin = std::chrono::steady_clock::now();
  const pid_t child = ::fork();
  if (child == 0) {
    const int out = ::open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(out, STDERR_FILENO);
    ::dup2(::open("/dev/null", O_WRONLY), STDOUT_FILENO);
    ::execl(SPINALTAP_PROGRAM, "spinaltap", "info", path.c_str(), "--resample", static_cast<char*>(nullptr));
    ::_exit(127);
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  MeasuredRun run;
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  run.peak_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  run.errors = read_whole_file(errors);
  return run;
}

class HostileCtGivenToTheProgram : public testing::TestWithParam<test::HostileCt> {};

TEST_P(HostileCtGivenToTheProgram, IsRejectedInTimeAndLittleMemory) {
  const test::TemporaryFolder folder;
  const test::TemporaryFolder beside;
  const std::filesystem::path path = GetParam().make(folder.path());
  const MeasuredRun run = run_info(path, beside.path() / "errors");
  EXPECT_EQ(run.exit_code, 2) << run.errors;
  EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
  EXPECT_THAT(run.errors, testing::StartsWith("spinaltap: "));
  EXPECT_THAT(run.errors, testing::HasSubstr(GetParam().word));
#if defined(SPINALTAP_ADDRESS_SANITIZER)  // which takes its time, and keeps what is freed
  EXPECT_LT(run.seconds, 5.0);
#else
  EXPECT_LT(run.seconds, 1.0);
  EXPECT_LT(run.peak_mb, 200.0);
#endif
  std::printf("%-40s %6.3f s %6.1f MB\n", GetParam().name.c_str(), run.seconds, run.peak_mb);
}

INSTANTIATE_TEST_SUITE_P(Every, HostileCtGivenToTheProgram, testing::ValuesIn(test::hostile_cts()),
                         [](const auto& hostile) { return hostile.param.name; });

}  // namespace
}  // namespace spinaltap

#include "tests/fuzz/fuzz_run.h"

#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <random>

#include "core/base/error.h"

#if defined(__SANITIZE_ADDRESS__)
constexpr double kMaxSeconds = 5.0;
#else
constexpr double kMaxSeconds = 1.0;
#endif

namespace spinaltap::test {
namespace {

/// Of this process: a busy machine makes no file slow.
double cpu_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

FuzzArguments fuzz_arguments(int argc, char** argv) {
  FuzzArguments arguments;
  arguments.seed = std::random_device()();
  for (int n = 1; n < argc; ++n) {
    const std::string argument = argv[n];
    if (argument == "--seconds" && n + 1 < argc) {
      arguments.seconds = std::strtod(argv[++n], nullptr);
    } else if (argument == "--seed" && n + 1 < argc) {
      arguments.seed = std::strtoull(argv[++n], nullptr, 10);
    } else {
      arguments.corpus.emplace_back(argument);
    }
  }
  return arguments;
}

bool survives(const std::function<void()>& read, FuzzCounts& counts) {
  const double begin_seconds = cpu_seconds();
  try {
    read();
    ++counts.read;
  } catch (const Error& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) {
      std::printf("a message of several lines: %s\n", error.what());
      return false;
    }
    ++counts.rejected;
  } catch (const std::exception& error) {
    std::printf("not an Error: %s\n", error.what());
    return false;
  }
  const double seconds = cpu_seconds() - begin_seconds;
  if (seconds < kMaxSeconds) return true;
  std::printf("took %.1f s of computing\n", seconds);
  return false;
}

void write_quickly(const std::filesystem::path& file, const std::string& bytes) {
  std::filesystem::remove(file);  // ext4 waits for the disk where a file that was cut to nothing is closed
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void print_fuzz_counts(const FuzzCounts& counts) {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  std::printf("%lld read, %lld rejected, none broke the reader; %ld MB at most\n", counts.read, counts.rejected,
              usage.ru_maxrss / 1024);
}

}  // namespace spinaltap::test

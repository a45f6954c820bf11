#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

// What the fuzz programs share. Each reads [--seconds N] [--seed N] [FILE ...].
namespace spinaltap::test {

struct FuzzArguments {
  double seconds = 60.0;
  std::uint64_t seed = 0;  ///< a random one unless given
  std::vector<std::filesystem::path> corpus;
};

FuzzArguments fuzz_arguments(int argc, char** argv);

struct FuzzCounts {
  long long read = 0;
  long long rejected = 0;
};

/// Runs `read`, which may throw an Error of one line. Prints what else it does, and returns false.
bool survives(const std::function<void()>& read, FuzzCounts& counts);

/// Unlike write_whole_file(), does not wait for the disk.
void write_quickly(const std::filesystem::path& file, const std::string& bytes);

/// Prints the counts and the most memory that was taken.
void print_fuzz_counts(const FuzzCounts& counts);

}  // namespace spinaltap::test

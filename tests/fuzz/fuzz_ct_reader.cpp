// Gives the CT reader damaged files for a while: valid files of every kind, changed at random. Reading them must give a
// CT or an Error, in time and without taking more memory than the file explains. Build it with sanitizers.
//
//   fuzz_ct_reader [--seconds N] [--seed N] [FILE ...]     FILE: more files to start from

#include <tbb/global_control.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/process_changes.h"
#include "core/base/staged_output.h"
#include "core/ct/read_ct.h"
#include "tests/fuzz/fuzz_run.h"
#include "tests/fuzz/mutate.h"
#include "tests/support/made_nifti.h"
#include "tests/support/made_series.h"
#include "tests/support/temporary_folder.h"

#if defined(__SANITIZE_ADDRESS__)
// The files are small: whoever asks for so much has believed a header. Leaks are not looked for: the JPEG-LS and JPEG
// 2000 decoders that GDCM brings lose a damaged picture's memory, which is not ours to free.
extern "C" const char* __asan_default_options() { return "max_allocation_size_mb=200:detect_leaks=0"; }
#endif

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// A folder with a valid CT; one of its files is changed at a time.
struct Start {
  std::string name;
  fs::path folder;
  fs::path read;  ///< what the reader is given: the folder or a file
  std::vector<test::MadeSeries::File> files;
  bool is_gzipped = false;  ///< change the bytes within as often as those around
};

class Starts {
 public:
  Starts() {
    for (const test::SeriesRecipe& recipe : test::every_kind_of_series()) {
      const test::MadeSeries made = test::make_series(recipe);
      // Two slices of a series will do, and are faster than six.
      std::vector<test::MadeSeries::File> files = made.files;
      if (files.size() > 2) files.resize(2);
      add(recipe.name, files);
    }
    for (const bool is_second : {false, true}) {
      for (const bool is_big_endian : {false, true}) {
        for (const auto type : {test::MadeNifti::Type::kInt16, test::MadeNifti::Type::kFloat}) {
          test::MadeNifti nifti;
          nifti.type = type;
          nifti.is_second = is_second;
          nifti.is_big_endian = is_big_endian;
          nifti.slope = is_second ? 2.0 : 0.0;
          nifti.ras_steps(1, 2) = is_second ? 0.3 : 0.0;  // leans
          for (int n = 0; n < 24; ++n) nifti.values.push_back(10.0 * n);
          add("NIfTI", {{"ct.nii", nifti.bytes()}}, "ct.nii");
          add("NIfTI, gzipped", {{"ct.nii.gz", test::gzipped(nifti.bytes())}}, "ct.nii.gz", nifti.bytes());
        }
      }
    }
  }

  void add(const std::string& name, const std::vector<test::MadeSeries::File>& files, const std::string& read = "",
           const std::string& unpacked = "") {
    Start start{name, temporary_.path() / std::to_string(starts_.size()), {}, files, !unpacked.empty()};
    fs::create_directory(start.folder);
    start.read = start.folder / read;
    for (const test::MadeSeries::File& file : files) test::write_quickly(start.folder / file.name, file.bytes);
    if (start.is_gzipped) start.files.push_back({files.front().name, unpacked});
    starts_.push_back(std::move(start));
  }

  std::size_t size() const { return starts_.size(); }
  const Start& operator[](std::size_t n) const { return starts_[n]; }

 private:
  test::TemporaryFolder temporary_;
  std::vector<Start> starts_;
};

int fuzz(double seconds, std::uint64_t seed, const std::vector<fs::path>& corpus) {
  Starts starts;
  for (const fs::path& file : corpus) {
    const std::string name = file.filename().string();
    starts.add(name, {{name, read_whole_file(file)}}, is_nifti_name(file) ? name : "");
  }
  std::printf("seed %llu, %zu files to start from, %.0f s\n", static_cast<unsigned long long>(seed), starts.size(),
              seconds);
  std::fflush(stdout);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  std::mt19937_64 random(seed);
  test::FuzzCounts counts;
  const Clock::time_point begin = Clock::now();
  const fs::path last = fs::temp_directory_path() / ("spinaltap-fuzz-" + std::to_string(::getpid()));
  while (seconds_since(begin) < seconds) {
    const Start& start = starts[random() % starts.size()];
    const Start& stranger = starts[random() % starts.size()];
    const test::MadeSeries::File& file = start.files[random() % start.files.size()];
    std::string bytes = test::mutated(file.bytes, stranger.files.front().bytes, random);
    if (start.is_gzipped && &file == &start.files.back()) bytes = test::gzipped(bytes);
    test::write_quickly(start.folder / file.name, bytes);
    test::write_quickly(last, bytes);  // stays behind when the program is stopped
    ::alarm(60);                       // stops a hang
    const auto read = [&] { static_cast<void>(read_ct(start.read, {.series = "1", .resample = true})); };
    if (!test::survives(read, counts)) {
      std::printf("found by seed %llu in a file made from: %s\nit is here: %s\n", static_cast<unsigned long long>(seed),
                  start.name.c_str(), last.c_str());
      return EXIT_FAILURE;
    }
    test::write_quickly(start.folder / file.name, start.is_gzipped ? start.files.front().bytes : file.bytes);
  }
  fs::remove(last);
  test::print_fuzz_counts(counts);
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace spinaltap

int main(int argc, char** argv) {
  spinaltap::allow_process_changes({.silences_decoders = true});
  const spinaltap::test::FuzzArguments arguments = spinaltap::test::fuzz_arguments(argc, argv);
  try {
    return spinaltap::fuzz(arguments.seconds, arguments.seed, arguments.corpus);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz_ct_reader: %s\n", error.what());
    return EXIT_FAILURE;
  }
}

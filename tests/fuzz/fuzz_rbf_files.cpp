// Gives the readers of radial basis functions and of values damaged files for a while: valid ones of every kind,
// changed at random. Reading them must give what they hold or an Error, in time and without taking more memory than the
// file explains. Build it with sanitizers.
//
//   fuzz_rbf_files [--seconds N] [--seed N] [FILE ...]     FILE: more files to start from

#include <unistd.h>
#include <zlib.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "core/base/staged_output.h"
#include "core/rbf/evaluated_file.h"
#include "core/rbf/rbf_file.h"
#include "core/rbf/value_file.h"
#include "tests/fuzz/fuzz_run.h"
#include "tests/fuzz/mutate.h"
#include "tests/support/made_nifti.h"
#include "tests/support/temporary_folder.h"

#if defined(__SANITIZE_ADDRESS__)
// The files are small: whoever asks for so much has believed a head.
extern "C" const char* __asan_default_options() { return "max_allocation_size_mb=50"; }
#endif

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

enum class Packing { none, gzip, checksum };

struct Start {
  std::string name;  ///< its ending chooses the reader
  std::string bytes;
  Packing packing = Packing::none;  ///< put around changed bytes, as often as not
};

std::string big_endian_ply() {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\ncomment c\nelement camera 1\nproperty list uchar int views\n"
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty list uint ushort near\n"
      "property double value\nproperty char error_bar\nend_header\n";
  bytes += std::string("\1\0\0\0\7", 5);
  for (int n = 0; n < 3; ++n) {
    bytes += std::string("\x40\x40\0\0\x3f\x80\0\0\xc0\0\0\0", 12);
    bytes += std::string("\0\0\0\1\0\5", 6) + std::string("\xbf\xf0\0\0\0\0\0\0\1", 9);
  }
  return bytes;
}

std::vector<Start> every_kind_of_file() {
  const test::TemporaryFolder folder;
  const auto bytes_of = [&](const std::string& name, const auto& write) {
    write(folder.path() / name);
    return read_whole_file(folder.path() / name);
  };
  std::vector<Start> starts;
  for (const RadialKernel kernel : {RadialKernel::biharmonic, RadialKernel::triharmonic}) {
    RbfModel model;
    model.kernel = kernel;
    model.centres_mm = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
    model.weights = {0.5, -1.0, 0.5};
    model.polynomial.assign(polynomial_terms(kernel), 0.25);
    starts.push_back(
        {"a.rbf", bytes_of("a.rbf", [&](const fs::path& path) { write_rbf(model, path); }), Packing::checksum});
  }
  const std::vector<Vec3> points_mm{{1, 2, 3}, {4.5, -5e-3, 6}, {7, 8, 9}};
  const std::vector<double> values_mm{0.5, -1.0, 0.25};
  for (const char* name : {"a.csv", "a.ply"}) {
    const auto write = [&](const fs::path& path) { write_evaluated({points_mm, values_mm, points_mm}, path); };
    starts.push_back({name, bytes_of(name, write)});
  }
  const std::string bars = "1,2,3,4,0.1\n4,5,6,-7,0\n1e1,2,3,4,.5\r\n";
  starts.push_back({"a.csv", bars});
  starts.push_back({"a.csv.gz", "note,\"x\",error_bar,y,z,value\n\"a,b\",1,0.1,2,3,4\n,4,0,5,6,-7\n", Packing::gzip});
  starts.push_back({"a.csv.gz", bars, Packing::gzip});
  starts.push_back({"a.ply", big_endian_ply()});
  starts.push_back({"a.ply",
                    "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int i\nelement vertex 2\n"
                    "property float x\nproperty float y\nproperty float z\nproperty list uint ushort near\n"
                    "property double value\nend_header\n3 0 1 2\n1 2 3 0 4\n4 5 6 2 8 9 -7\n"});
  return starts;
}

std::string packed(std::string bytes, Packing packing) {
  if (packing == Packing::gzip) return test::gzipped(bytes);
  if (packing == Packing::checksum && bytes.size() >= 4) {
    const std::size_t end = bytes.size() - 4;
    const auto crc = static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), end));
    std::memcpy(bytes.data() + end, &crc, sizeof crc);
  }
  return bytes;
}

int fuzz(const test::FuzzArguments& arguments) {
  std::vector<Start> starts = every_kind_of_file();
  for (const fs::path& file : arguments.corpus) starts.push_back({file.filename().string(), read_whole_file(file)});
  std::printf("seed %llu, %zu files to start from, %.0f s\n", static_cast<unsigned long long>(arguments.seed),
              starts.size(), arguments.seconds);
  std::fflush(stdout);
  std::mt19937_64 random(arguments.seed);
  test::FuzzCounts counts;
  const fs::path folder = fs::temp_directory_path() / ("spinaltap-fuzz-" + std::to_string(::getpid()));
  fs::create_directory(folder);  // stays behind when the program is stopped
  const Clock::time_point begin = Clock::now();
  while (std::chrono::duration<double>(Clock::now() - begin).count() < arguments.seconds) {
    const Start& start = starts[random() % starts.size()];
    const Start& stranger = starts[random() % starts.size()];
    const bool changes_inside = random() % 2 == 0;
    std::string bytes =
        test::mutated(changes_inside ? start.bytes : packed(start.bytes, start.packing), stranger.bytes, random);
    if (changes_inside) bytes = packed(std::move(bytes), start.packing);
    const fs::path file = folder / start.name;
    test::write_quickly(file, bytes);
    ::alarm(60);  // stops a hang
    const bool is_model = file.extension() == ".rbf";
    const auto read = [&] { is_model ? check_model(read_rbf(file)) : static_cast<void>(read_values(file)); };
    const auto read_bare = [&] { static_cast<void>(read_positions(file)); };
    if (!test::survives(read, counts) || !(is_model || test::survives(read_bare, counts))) {
      std::printf("found by seed %llu; it is here: %s\n", static_cast<unsigned long long>(arguments.seed),
                  file.c_str());
      return EXIT_FAILURE;
    }
  }
  fs::remove_all(folder);
  test::print_fuzz_counts(counts);
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace spinaltap

int main(int argc, char** argv) {
  try {
    return spinaltap::fuzz(spinaltap::test::fuzz_arguments(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz_rbf_files: %s\n", error.what());
    return EXIT_FAILURE;
  }
}

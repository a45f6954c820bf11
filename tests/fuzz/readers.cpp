#include "tests/fuzz/readers.h"

#include <algorithm>
#include <ctime>
#include <exception>
#include <fstream>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "tests/fuzz/mutate.h"
#include "tests/support/temporary_folder.h"

#if defined(SPINALTAP_ADDRESS_SANITIZER)
constexpr double kMaxSeconds = 5.0;
#else
constexpr double kMaxSeconds = 1.0;
#endif

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

/// Of this process: a busy machine makes no file slow.
double cpu_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::string packed(const SeedFile& file, const std::string& content) {
  return file.pack ? file.pack(content) : content;
}

std::ptrdiff_t file_count(const fs::path& folder) {
  return std::distance(fs::recursive_directory_iterator(folder), fs::recursive_directory_iterator());
}

}  // namespace

const std::vector<Reader>& all_readers() {
  static const std::vector<Reader> readers = [] {
    std::vector<Reader> all;
    add_ct_readers(all);
    add_vdb_readers(all);
    add_session_readers(all);
    add_settings_readers(all);
    add_table_readers(all);
    add_mesh_readers(all);
    add_link_readers(all);
    add_registration_readers(all);
    return all;
  }();
  return readers;
}

const Reader& reader_called(const std::string& name) {
  std::string names;
  for (const Reader& reader : all_readers()) {
    if (reader.name == name) return reader;
    names += " " + reader.name;
  }
  fail("expected one of", names, "; found ", name);
}

std::string bytes_written(const std::string& name, const std::function<void(const fs::path&)>& write) {
  const TemporaryFolder folder;
  write(folder.path() / name);
  return read_whole_file(folder.path() / name);
}

std::vector<SeedFile> files_in(const fs::path& folder) {
  std::vector<SeedFile> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    files.push_back({entry.path().filename().string(), read_whole_file(entry.path())});
  }
  std::sort(files.begin(), files.end(), [](const SeedFile& a, const SeedFile& b) { return a.name < b.name; });
  return files;
}

fs::path only_file(const fs::path& folder) {
  const fs::directory_iterator files(folder);
  if (files == fs::directory_iterator() || file_count(folder) != 1) fail("expected one file in ", folder.string());
  return files->path();
}

Case changed_case(const Seed& seed, const std::vector<Seed>& strangers, std::mt19937_64& random) {
  const SeedFile& file = seed.files[random() % seed.files.size()];
  const Seed& stranger = strangers[random() % strangers.size()];
  const std::string& other = stranger.files[random() % stranger.files.size()].content;
  if (file.pack && random() % 2 == 0) return {file.name, mutated(packed(file, file.content), other, random)};
  const bool changes_values = file.is_json && random() % 2 == 0;
  return {file.name, packed(file, changes_values ? mutated_json(file.content, other, random)
                                                 : mutated(file.content, other, random))};
}

std::vector<Case> unchanged(const Seed& seed) {
  std::vector<Case> files;
  for (const SeedFile& file : seed.files) files.push_back({file.name, packed(file, file.content)});
  return files;
}

Outcome outcome_of(const Reader& reader, const fs::path& folder) {
  Outcome outcome;
  const std::ptrdiff_t files = file_count(folder);
  const double begin_seconds = cpu_seconds();
  try {
    reader.read(folder);
    outcome.is_read = true;
  } catch (const Error& error) {
    outcome.message = error.what();
    if (outcome.message.empty()) outcome.finding = "an empty message";
    if (outcome.message.find('\n') != std::string::npos)
      outcome.finding = "a message of several lines: " + outcome.message;
    constexpr std::size_t kMaxMessage = 1000;
    if (outcome.message.size() > kMaxMessage) {
      outcome.finding =
          "a message of " + std::to_string(outcome.message.size()) + " letters: " + outcome.message.substr(0, 200);
    }
  } catch (const std::exception& error) {
    outcome.finding = std::string("not an Error: ") + error.what();
  }
  const double seconds = cpu_seconds() - begin_seconds;
  if (!(seconds < kMaxSeconds)) outcome.finding = "took " + std::to_string(seconds) + " s of computing";
  if (file_count(folder) != files) outcome.finding = "left files behind";
  return outcome;
}

void write_quickly(const fs::path& file, const std::string& bytes) {
  fs::remove(file);  // ext4 waits for the disk where a file that was cut to nothing is closed
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace spinaltap::test

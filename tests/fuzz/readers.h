#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

// The table of all that SpinalTap reads: what valid files look like, and how each is read. Damaged ones are made of it
// (fuzz_readers), and those that once broke a reader are read through it (found_test).
namespace spinaltap::test {

/// A valid file that damaged ones are made from.
struct SeedFile {
  std::string name;
  /// What is changed: the file's bytes or, where they are packed, what they were packed from.
  std::string content;
  /// Makes the file's bytes of a changed content: compresses it, or puts its checksum right. Empty: they are the same.
  std::function<std::string(const std::string&)> pack = {};
  bool is_json = false;  ///< of the content: its values are changed as often as its bytes
};

/// A folder with valid files, of which a case changes one.
struct Seed {
  std::string name;  ///< in words
  std::vector<SeedFile> files;
};

struct Reader {
  std::string name;  ///< as in `--reader`, and of its folder in tests/fuzz/found
  std::function<std::vector<Seed>()> seeds;
  /// Reads what is in a folder and uses it as a program would. May throw an Error of one line.
  std::function<void(const std::filesystem::path&)> read;
  /// The files are small: whoever asks for so much at once has believed a head.
  std::size_t max_allocation = std::size_t{50} << 20;
  /// GDCM's decoders of JPEG-LS and JPEG 2000 lose a damaged picture's memory, which is not ours to free.
  bool loses_memory = false;
};

const std::vector<Reader>& all_readers();
/// Throws Error that lists the names where there is none.
const Reader& reader_called(const std::string& name);

// By what they read; all_readers() has them all.
void add_ct_readers(std::vector<Reader>& readers);
void add_settings_readers(std::vector<Reader>& readers);
void add_table_readers(std::vector<Reader>& readers);
void add_mesh_readers(std::vector<Reader>& readers);
void add_vdb_readers(std::vector<Reader>& readers);
void add_session_readers(std::vector<Reader>& readers);
void add_link_readers(std::vector<Reader>& readers);
void add_registration_readers(std::vector<Reader>& readers);

/// The bytes of the file that `write` makes under the name that it is given.
std::string bytes_written(const std::string& name, const std::function<void(const std::filesystem::path&)>& write);
/// All files in a folder, by their names.
std::vector<SeedFile> files_in(const std::filesystem::path& folder);
/// The folder's only file. Throws Error where there are more.
std::filesystem::path only_file(const std::filesystem::path& folder);

/// The seed's files, with one changed: the same random numbers make the same case.
struct Case {
  std::string name;  ///< of the file that was changed
  std::string bytes;
};
Case changed_case(const Seed& seed, const std::vector<Seed>& strangers, std::mt19937_64& random);
/// As changed_case() with nothing changed.
std::vector<Case> unchanged(const Seed& seed);

/// What reading a folder came to.
struct Outcome {
  bool is_read = false;  ///< else it was rejected, with `message`
  std::string message;
  std::string finding;  ///< what a reader must not do; empty where it did not
};
/// Reads it: an Error of one line is all that may be thrown, in time, and no file may be left behind.
Outcome outcome_of(const Reader& reader, const std::filesystem::path& folder);

/// Unlike write_whole_file(), does not wait for the disk.
void write_quickly(const std::filesystem::path& file, const std::string& bytes);

}  // namespace spinaltap::test

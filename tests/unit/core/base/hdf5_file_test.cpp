// What lies in a file, looked at without HDF5: whichever HDF5 writes it, 1.10 must read it.

#include "core/base/hdf5_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/staged_output.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

/// Of the format's messages that a version stands in.
enum Message : unsigned { kDataspace = 1, kDatatype = 3, kFill = 5, kLayout = 8, kPipeline = 11, kAttribute = 12 };

std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t number = 0;
  for (std::size_t n = 0; n < size; ++n)
    number |= std::uint64_t{static_cast<unsigned char>(bytes.at(at + n))} << (8 * n);
  return number;
}

/// The greatest version of each kind of message in all objects' headers (of version 2: HDF5's format specification,
/// section IV.A.1.b), but for what later pieces of a header hold.
std::map<unsigned, unsigned> message_versions(std::string_view bytes) {
  std::map<unsigned, unsigned> versions;
  for (std::size_t head = bytes.find("OHDR"); head != std::string_view::npos; head = bytes.find("OHDR", head + 4)) {
    const std::uint64_t flags = number_at(bytes, head + 5, 1);
    std::size_t at = head + 6;
    if ((flags & 0x20U) != 0) at += 16;  // times
    if ((flags & 0x10U) != 0) at += 4;   // when attributes move elsewhere
    const std::size_t width = std::size_t{1} << (flags & 3U);
    const std::size_t end = at + width + number_at(bytes, at, width);
    at += width;
    const std::size_t message_head = (flags & 4U) != 0 ? 6 : 4;
    while (at + message_head < end) {
      const auto kind = static_cast<unsigned>(number_at(bytes, at, 1));
      const std::size_t size = number_at(bytes, at + 1, 2);
      at += message_head;
      if (size > 0) {
        auto version = static_cast<unsigned>(number_at(bytes, at, 1));
        if (kind == kDatatype) version >>= 4U;
        versions[kind] = std::max(versions[kind], version);
      }
      at += size;
    }
  }
  return versions;
}

std::string bytes_of_a_file(const std::filesystem::path& path) {
  Hdf5File file = Hdf5File::create(path);
  file.write_text("/", "format", "test");
  file.make_group("/part");
  file.write_text("/part", "name", "of its own");
  Hdf5Table packed = file.make_table("/part/packed", Hdf5Number::f64, 3, 16, true);
  Hdf5Table plain = file.make_table("/part/plain", Hdf5Number::u32, Hdf5Row::array({2, 2}), 16, false);
  Hdf5Table row = file.make_row("/part/row", Hdf5Number::u64, 5);
  file.let_others_read();
  std::vector<double> numbers(3 * 100);
  std::iota(numbers.begin(), numbers.end(), 0.5);
  packed.write(0, 100, numbers.data());
  plain.write(0, 75, numbers.data());
  row.write(0, 1, numbers.data());
  file.close();
  return read_whole_file(path);
}

TEST(Hdf5File, IsWrittenAsHdf5110ReadsIt) {
  const test::TemporaryFolder folder;
  const std::string bytes = bytes_of_a_file(folder.path() / "file.h5");
  constexpr std::size_t kSuperblockVersion = 8;
  EXPECT_EQ(number_at(bytes, kSuperblockVersion, 1), 3U) << "which readers along with a writer take";
  // The newest of each that 1.10 knows. Of what later ones write, it knows neither types (4, from 1.12) nor layouts (5,
  // from 2.0).
  const std::map<unsigned, unsigned> versions = message_versions(bytes);
  EXPECT_EQ(versions.at(kDataspace), 2U);
  EXPECT_LE(versions.at(kDatatype), 3U);
  EXPECT_EQ(versions.at(kFill), 3U);
  EXPECT_EQ(versions.at(kLayout), 4U);
  EXPECT_EQ(versions.at(kPipeline), 2U);
  EXPECT_EQ(versions.at(kAttribute), 3U);
}

}  // namespace
}  // namespace spinaltap

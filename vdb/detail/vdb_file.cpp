#include "vdb/detail/vdb_file.h"

#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <cctype>
#include <fstream>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap {

void initialize_openvdb() { openvdb::initialize(); }

}  // namespace spinaltap

namespace spinaltap::detail {
namespace {

/// Throws Error unless it is a file; OpenVDB is ready then.
void expect_file(const std::filesystem::path& path) {
  initialize_openvdb();
  std::error_code status;
  if (!std::filesystem::exists(path, status)) fail("no such file: ", path.string());
  if (!std::filesystem::is_regular_file(path, status)) {
    fail("expected a .vdb file, found something else: ", path.string());
  }
}

/// OpenVDB puts a random tag into each file's head. One made from the content keeps equal models' files equal.
void replace_random_tag(const std::filesystem::path& path, const std::string& digits) {
  constexpr std::streamoff kTagOffset = 8 + 4 + 4 + 4 + 1;  // magic, file version, library version, has-offsets
  constexpr std::size_t kTagLength = 36;
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  std::string tag(kTagLength, ' ');
  file.seekg(kTagOffset);
  file.read(tag.data(), kTagLength);
  for (std::size_t i = 0, digit = 0; i < kTagLength; ++i) {
    const bool dash = i == 8 || i == 13 || i == 18 || i == 23;
    if (!file || (tag[i] == '-') != dash || (!dash && std::isxdigit(static_cast<unsigned char>(tag[i])) == 0)) {
      fail("cannot write ", path.string(), ": not the file head that OpenVDB 10 writes");
    }
    if (!dash) tag[i] = digits[digit++ % digits.size()];
  }
  file.seekp(kTagOffset);
  file.write(tag.data(), kTagLength);
  file.close();
  if (!file) fail("cannot write ", path.string());
}

}  // namespace

std::string printable(const std::string& message) {
  constexpr std::size_t kMax = 160;
  std::string text;
  for (const char c : message.substr(0, kMax)) text += c >= ' ' && c <= '~' ? c : '?';
  return text;
}

openvdb::GridPtrVecPtr read_vdb(const std::filesystem::path& path) {
  expect_file(path);
  try {
    // OpenVDB does not look whether it got the bytes that it asked for. This stream throws when they run out, so that a
    // file cut short is noticed, even by one byte, before garbage is taken for sizes.
    std::ifstream bytes;
    bytes.exceptions(std::ios::failbit | std::ios::badbit);
    bytes.open(path, std::ios::binary);
    openvdb::io::Stream stream(bytes, false);
    return stream.getGrids();
  } catch (const std::exception& error) {
    fail("cannot read ", path.string(), ": ", printable(error.what()));
  }
}

void write_vdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids, const std::string& content_hash,
               const openvdb::MetaMap& metadata) {
  initialize_openvdb();
  openvdb::io::File file(path.string());
  file.write(grids, metadata);
  file.close();
  replace_random_tag(path, content_hash);
}

bool fits_half_floats(const openvdb::FloatGrid& grid) {
  const auto fits = [](float value) { return rounded_to_half(value) == value; };
  for (auto value = grid.cbeginValueAll(); value; ++value) {
    if (!fits(*value)) return false;
  }
  return fits(grid.background());
}

void add_metadata(const std::map<std::string, std::string>& metadata, openvdb::FloatGrid& sdf) {
  for (const auto& [key, value] : metadata) sdf.insertMeta(kMetadataPrefix + key, openvdb::StringMetadata(value));
  sdf.insertMeta(kBoneFormatKey, openvdb::StringMetadata(kBoneFormatVersion));
}

std::map<std::string, std::string> metadata_of(const openvdb::FloatGrid& sdf, const std::filesystem::path& path) {
  const std::string prefix = kMetadataPrefix;
  std::map<std::string, std::string> metadata;
  for (auto meta = sdf.beginMeta(); meta != sdf.endMeta(); ++meta) {
    if (meta->first.rfind(prefix, 0) == 0) metadata[meta->first.substr(prefix.size())] = meta->second->str();
  }
  const auto version = metadata.extract(std::string(kBoneFormatKey).substr(prefix.size()));
  const std::string found = version.empty() ? "1" : version.mapped();
  if (found != kBoneFormatVersion && !(version.empty() && metadata.empty())) {
    fail(path.string(), ": this is a version ", printable(found), " bone; version ", kBoneFormatVersion,
         " is expected: bake again");
  }
  return metadata;
}

NamedGrids::NamedGrids(const std::filesystem::path& path) : path_(path) {
  expect_file(path);
  try {
    bytes_.exceptions(std::ios::failbit | std::ios::badbit);
    bytes_.open(path, std::ios::binary);
    stream_metadata_.reset(new openvdb::io::StreamMetadata);
    openvdb::io::setStreamMetadataPtr(bytes_, stream_metadata_, /*transfer=*/false);
    readHeader(bytes_);
    setFormatVersion(bytes_);
    setLibraryVersion(bytes_);
    setDataCompression(bytes_);
    metadata_.readMeta(bytes_);
    if (!inputHasGridOffsets()) return;
    constexpr std::int32_t kMaxGrids = 1000;
    const std::int32_t count = readGridCount(bytes_);
    if (count < 0 || count > kMaxGrids) fail("expected at most ", kMaxGrids, " grids, found ", count);
    for (std::int32_t n = 0; n < count; ++n) {
      openvdb::io::GridDescriptor place;
      place.read(bytes_);
      places_[place.gridName()] = place;
      place.seekToEnd(bytes_);
    }
  } catch (const std::exception& error) {
    fail("cannot read ", path.string(), ": ", printable(error.what()));
  }
}

template <class GridType>
typename GridType::Ptr NamedGrids::read(const std::string& name, const openvdb::CoordBBox* box) {
  const auto found = places_.find(name);
  if (found == places_.end()) fail("expected a grid ", name, " in ", path_.string(), ", found none");
  const openvdb::io::GridDescriptor& place = found->second;
  if (place.gridType() != GridType::gridType() || place.isInstance()) {
    fail("expected the grid ", name, " of another kind in ", path_.string(), ", found ", printable(place.gridType()));
  }
  try {
    auto grid = GridType::create();
    grid->setName(name);
    grid->setSaveFloatAsHalf(place.saveFloatAsHalf());
    place.seekToGrid(bytes_);
    if (box != nullptr) {
      readGrid(grid, place, bytes_, *box);
    } else {
      readGrid(grid, place, bytes_);
    }
    return grid;
  } catch (const std::exception& error) {
    fail("cannot read the grid ", name, " in ", path_.string(), ": ", printable(error.what()));
  }
}

openvdb::FloatGrid::Ptr NamedGrids::read_floats(const std::string& name) {
  return read<openvdb::FloatGrid>(name, nullptr);
}

openvdb::FloatGrid::Ptr NamedGrids::read_floats(const std::string& name, const openvdb::CoordBBox& box) {
  return read<openvdb::FloatGrid>(name, &box);
}

openvdb::MaskGrid::Ptr NamedGrids::read_mask(const std::string& name) { return read<openvdb::MaskGrid>(name, nullptr); }

}  // namespace spinaltap::detail

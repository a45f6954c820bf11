#include "vdb/detail/named_grids.h"

#include "core/base/error.h"
#include "vdb/detail/initialize.h"
#include "vdb/detail/vdb_file.h"

namespace spinaltap::detail {

NamedGrids::NamedGrids(const std::filesystem::path& path) : path_(path) {
  initialize_openvdb();
  std::error_code status;
  if (!std::filesystem::exists(path, status)) fail("no such file: ", path.string());
  if (!std::filesystem::is_regular_file(path, status)) {
    fail("expected a .vdb file, found something else: ", path.string());
  }
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
    constexpr std::int32_t kMostGrids = 1000;
    const std::int32_t count = readGridCount(bytes_);
    if (count < 0 || count > kMostGrids) fail("expected at most ", kMostGrids, " grids, found ", count);
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

#pragma once

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace spinaltap::detail {

/// A .vdb file of which grids are read by name, and the rest is not. openvdb::io::File does that too, but takes what
/// a damaged file's sizes say without a look whether the bytes are there; here the stream throws when they run out.
class NamedGrids : private openvdb::io::Archive {
 public:
  /// Reads the head. Throws Error on a missing file and one that is no .vdb or damaged.
  explicit NamedGrids(const std::filesystem::path& path);

  /// The file's own metadata, not a grid's.
  const openvdb::MetaMap& metadata() const { return metadata_; }
  /// False too where the file was written without places to jump to, as into a pipe.
  bool has(const std::string& name) const { return places_.contains(name); }

  /// A grid of floats, or its part in a box of voxels. Throws Error where there is none of that name, it is another
  /// kind of grid, or is damaged.
  openvdb::FloatGrid::Ptr read_floats(const std::string& name);
  openvdb::FloatGrid::Ptr read_floats(const std::string& name, const openvdb::CoordBBox& box);
  /// A grid that says which voxels there are, and no more.
  openvdb::MaskGrid::Ptr read_mask(const std::string& name);

 private:
  template <class GridType>
  typename GridType::Ptr read(const std::string& name, const openvdb::CoordBBox* box);

  std::filesystem::path path_;
  openvdb::io::StreamMetadata::Ptr stream_metadata_;  // the stream keeps the address of this very pointer
  std::ifstream bytes_;
  openvdb::MetaMap metadata_;
  std::map<std::string, openvdb::io::GridDescriptor> places_;
};

}  // namespace spinaltap::detail

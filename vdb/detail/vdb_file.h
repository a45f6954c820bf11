#pragma once

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace spinaltap {

/// Registers OpenVDB's grid types. Every function of vdb/ that needs it calls it; more calls cost nothing.
void initialize_openvdb();

}  // namespace spinaltap

namespace spinaltap::detail {

/// Before the names of our own metadata.
constexpr const char* kMetadataPrefix = "spinaltap:";
/// Of them, what says by which names the others go; docs/bone-vdb.md.
constexpr const char* kBoneFormatKey = "spinaltap:format_version";
constexpr const char* kBoneFormatVersion = "2";

/// All grids of a .vdb file. Throws Error on a missing file, one that is no .vdb, and one cut short by even one byte.
openvdb::GridPtrVecPtr read_vdb(const std::filesystem::path& path);

/// Writes grids to a .vdb file. `content_hash`: hex digits made from the content, of which the file's tag is made, so
/// that equal grids give equal files. Throws OpenVDB's errors and Error; does not notice a full disk's last bytes.
void write_vdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids, const std::string& content_hash,
               const openvdb::MetaMap& metadata = {});

/// Whether a file of half floats gives every value back.
bool fits_half_floats(const openvdb::FloatGrid& grid);

/// Adds a bone's metadata to its grid's, and the format's version.
void add_metadata(const std::map<std::string, std::string>& metadata, openvdb::FloatGrid& sdf);
/// The metadata of a bone, from its grid's. Throws Error where they are of another version; a grid of another program
/// has none.
std::map<std::string, std::string> metadata_of(const openvdb::FloatGrid& sdf, const std::filesystem::path& path);

/// The start of a message that may quote a damaged file's bytes.
std::string printable(const std::string& message);

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

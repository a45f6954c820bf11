#pragma once

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointDataGrid.h>

#include <filesystem>
#include <istream>
#include <map>
#include <streambuf>
#include <string>
#include <vector>

#include "vdb/detail/vdb_layout.h"

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
/// Of a file of several bones: "T11 T12".
constexpr const char* kLevelsKey = "spinaltap:levels";

/// Writes grids to a .vdb file and seals it (seal_vdb()), so that equal grids give equal files. Throws OpenVDB's errors
/// and Error; does not notice a full disk's last bytes.
void write_vdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
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

/// Bytes in memory as a stream that can be read.
class MemoryBuffer : public std::streambuf {
 public:
  explicit MemoryBuffer(std::string bytes);
  std::string& bytes() { return bytes_; }

 protected:
  pos_type seekoff(off_type offset, std::ios::seekdir from, std::ios::openmode) override;
  pos_type seekpos(pos_type at, std::ios::openmode mode) override { return seekoff(at, std::ios::beg, mode); }

 private:
  std::string bytes_;
};

/// A .vdb file, read into memory and checked (check_vdb()), of which grids are read one by one. Each is checked before
/// OpenVDB gets to read it (check_vdb_grid()). Where several have one name, the first is meant.
class VdbFile : private openvdb::io::Archive {
 public:
  /// Throws Error on a missing file, one over 8 GiB, and one that is no .vdb or damaged.
  explicit VdbFile(const std::filesystem::path& path);

  /// The file's own metadata, not a grid's.
  const openvdb::MetaMap& metadata() const { return metadata_; }
  std::vector<std::string> names() const;
  bool has(const std::string& name) const { return find(name) != nullptr; }

  /// A grid of floats, or its part in a box of voxels. Throws Error where there is none of that name, it is another
  /// kind of grid, is damaged, or a value of it is no number.
  openvdb::FloatGrid::Ptr read_floats(const std::string& name, const openvdb::CoordBBox* box = nullptr);
  /// All grids of floats, whatever their values.
  std::vector<openvdb::FloatGrid::Ptr> read_all_floats();
  /// A grid that says which voxels there are, and no more.
  openvdb::MaskGrid::Ptr read_mask(const std::string& name);
  /// A grid of points. Out of sealed files alone: how they are packed is not checked.
  openvdb::points::PointDataGrid::Ptr read_points(const std::string& name);

 private:
  VdbFile(const std::filesystem::path& path, std::string bytes);
  const VdbGrid* find(const std::string& name) const;
  const VdbGrid& expect(const std::string& name, std::string_view type, const char* kind) const;
  /// Throws Error without the file's name.
  template <class GridType>
  typename GridType::Ptr read(const VdbGrid& place, const openvdb::CoordBBox* box = nullptr);
  openvdb::FloatGrid::Ptr read_floats(const VdbGrid& place, const openvdb::CoordBBox* box);

  std::filesystem::path path_;
  openvdb::io::StreamMetadata::Ptr stream_metadata_;  // the stream keeps the address of this very pointer
  MemoryBuffer buffer_;
  std::istream stream_;
  openvdb::MetaMap metadata_;
  VdbLayout layout_;
};

}  // namespace spinaltap::detail

#include "vdb/detail/vdb_file.h"

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap {

void initialize_openvdb() { openvdb::initialize(); }

}  // namespace spinaltap

namespace spinaltap::detail {
namespace {

using openvdb::points::PointDataGrid;

/// Throws Error unless it is a file; OpenVDB is ready then.
void expect_file(const std::filesystem::path& path) {
  initialize_openvdb();
  std::error_code status;
  if (!std::filesystem::exists(path, status)) fail_as(ErrorKind::file, "no such file: ", path.string());
  if (!std::filesystem::is_regular_file(path, status)) {
    fail("expected a .vdb file, found something else: ", path.string());
  }
}

constexpr std::size_t kMaxBytes = std::size_t{8} << 30;

bool has_numbers_only(const openvdb::FloatGrid& grid) {
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const float* const values = leaf->buffer().data();
    float sum = 0.0F;  // stays so: all but numbers give no number times 0
    for (openvdb::Index n = 0; n < openvdb::FloatTree::LeafNodeType::SIZE; ++n) sum += 0.0F * values[n];
    if (!(sum == 0.0F)) return false;
  }
  auto tile = grid.tree().cbeginValueAll();
  tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (!std::isfinite(*tile)) return false;
  }
  return std::isfinite(grid.background());
}

std::string bytes_of_vdb(const std::filesystem::path& path) {
  expect_file(path);
  return read_whole_file(path, kMaxBytes);
}

}  // namespace

std::string printable(const std::string& message) {
  constexpr std::size_t kMax = 160;
  std::string text;
  for (const char c : message.substr(0, kMax)) text += c >= ' ' && c <= '~' ? c : '?';
  return text;
}

void write_vdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) {
  initialize_openvdb();
  openvdb::io::File file(path.string());
  file.write(grids, metadata);
  file.close();
  std::string bytes = read_whole_file(path, kMaxBytes);
  seal_vdb(bytes);
  write_whole_file(path, bytes);
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

MemoryBuffer::MemoryBuffer(std::string bytes) : bytes_(std::move(bytes)) {
  setg(bytes_.data(), bytes_.data(), bytes_.data() + bytes_.size());
}

MemoryBuffer::pos_type MemoryBuffer::seekoff(off_type offset, std::ios::seekdir from, std::ios::openmode) {
  off_type at = offset;
  if (from == std::ios::cur) at += gptr() - eback();
  if (from == std::ios::end) at += egptr() - eback();
  if (at < 0 || at > egptr() - eback()) return pos_type(off_type(-1));
  setg(eback(), eback() + at, egptr());
  return pos_type(at);
}

VdbFile::VdbFile(const std::filesystem::path& path) : VdbFile(path, bytes_of_vdb(path)) {}

VdbFile::VdbFile(const std::filesystem::path& path, std::string bytes)
    : path_(path), buffer_(std::move(bytes)), stream_(&buffer_) {
  try {
    layout_ = check_vdb(buffer_.bytes());
    // OpenVDB does not look whether it got the bytes that it asked for.
    stream_.exceptions(std::ios::failbit | std::ios::badbit);
    stream_metadata_.reset(new openvdb::io::StreamMetadata);
    openvdb::io::setStreamMetadataPtr(stream_, stream_metadata_, /*transfer=*/false);
    readHeader(stream_);
    setFormatVersion(stream_);
    setLibraryVersion(stream_);
    setDataCompression(stream_);
    metadata_.readMeta(stream_);
  } catch (const std::exception& error) {
    fail("cannot read ", path.string(), ": ", printable(error.what()));
  }
}

std::vector<std::string> VdbFile::names() const {
  std::vector<std::string> names;
  for (const VdbGrid& grid : layout_.grids) names.push_back(grid.name);
  return names;
}

const VdbGrid* VdbFile::find(const std::string& name) const {
  for (const VdbGrid& grid : layout_.grids) {
    if (grid.name == name) return &grid;
  }
  return nullptr;
}

const VdbGrid& VdbFile::expect(const std::string& name, std::string_view type, const char* kind) const {
  const VdbGrid* const found = find(name);
  if (found == nullptr) fail("expected a grid ", name, " in ", path_.string(), ", found none");
  if (found->type != type) {
    fail("expected ", kind, " as the grid ", name, " in ", path_.string(), ", found ", printable(found->type));
  }
  return *found;
}

template <class GridType>
typename GridType::Ptr VdbFile::read(const VdbGrid& place, const openvdb::CoordBBox* box) {
  try {
    if constexpr (!std::is_same_v<GridType, PointDataGrid>) check_vdb_grid(buffer_.bytes(), place);
    auto grid = GridType::create();
    grid->setName(place.name);
    openvdb::io::GridDescriptor descriptor(place.unique_name, place.type);
    descriptor.setInstanceParentName(place.parent);
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(place.begin));
    if (box != nullptr) {
      readGrid(grid, descriptor, stream_, *box);
    } else {
      readGrid(grid, descriptor, stream_);
    }
    return grid;
  } catch (const std::exception& error) {
    fail("cannot read the grid ", printable(place.name), " in ", path_.string(), ": ", printable(error.what()));
  }
}

openvdb::FloatGrid::Ptr VdbFile::read_floats(const VdbGrid& place, const openvdb::CoordBBox* box) {
  openvdb::FloatGrid::Ptr grid = read<openvdb::FloatGrid>(place, box);
  if (!place.parent.empty()) {
    const auto parent = std::find_if(layout_.grids.begin(), layout_.grids.end(),
                                     [&](const VdbGrid& one) { return one.unique_name == place.parent; });
    if (parent == layout_.grids.end() || !parent->parent.empty() || parent->type != kFloatGridType) {
      fail("expected the grid whose values ", printable(place.name), " shares in ", path_.string(), ", found none");
    }
    grid->setTree(read<openvdb::FloatGrid>(*parent, box)->treePtr());
  }
  return grid;
}

openvdb::FloatGrid::Ptr VdbFile::read_floats(const std::string& name, const openvdb::CoordBBox* box) {
  openvdb::FloatGrid::Ptr grid = read_floats(expect(name, kFloatGridType, "floats"), box);
  if (!has_numbers_only(*grid)) {
    fail("expected numbers in the grid ", name, " in ", path_.string(), ", found a value that is none");
  }
  return grid;
}

std::vector<openvdb::FloatGrid::Ptr> VdbFile::read_all_floats() {
  std::vector<openvdb::FloatGrid::Ptr> grids;
  for (const VdbGrid& grid : layout_.grids) {
    if (grid.type == kFloatGridType) grids.push_back(read_floats(grid, nullptr));
  }
  return grids;
}

openvdb::MaskGrid::Ptr VdbFile::read_mask(const std::string& name) {
  return read<openvdb::MaskGrid>(expect(name, kMaskGridType, "a mask"));
}

PointDataGrid::Ptr VdbFile::read_points(const std::string& name) {
  const VdbGrid& place = expect(name, PointDataGrid::gridType(), "a grid of points");
  if (!layout_.is_sealed) {
    fail("expected points that SpinalTap wrote, with a checksum, found none in ", path_.string());
  }
  return read<PointDataGrid>(place);
}

}  // namespace spinaltap::detail

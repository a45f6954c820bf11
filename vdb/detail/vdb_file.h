#pragma once

#include <openvdb/openvdb.h>

#include <filesystem>
#include <map>
#include <string>

namespace spinaltap::detail {

/// Before the names of our own metadata.
constexpr const char* kFactPrefix = "spinaltap:";

/// All grids of a .vdb file. Throws Error on a missing file, one that is no .vdb, and one cut short by even one byte.
openvdb::GridPtrVecPtr read_vdb(const std::filesystem::path& path);

/// Writes grids to a .vdb file. `content_hash`: hex digits made from the content, of which the file's tag is made, so
/// that equal grids give equal files. Throws OpenVDB's errors and Error; does not notice a full disk's last bytes.
void write_vdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids, const std::string& content_hash,
               const openvdb::MetaMap& metadata = {});

/// Whether a file of half floats gives every value back.
bool fits_half_floats(const openvdb::FloatGrid& grid);

/// The facts of a bone, from its grid's metadata.
std::map<std::string, std::string> facts_of(const openvdb::FloatGrid& sdf);

/// The start of a message that may quote a damaged file's bytes.
std::string printable(const std::string& message);

}  // namespace spinaltap::detail

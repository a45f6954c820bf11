#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

// What a .vdb file's bytes promise, looked at before OpenVDB reads them. OpenVDB's reader (10.0) trusts what it reads:
// sizes, counts and offsets of a damaged file make it write past its buffers, or take gigabytes.
namespace spinaltap::detail {

/// One grid as a file's head describes it.
struct VdbGrid {
  std::string name;
  std::string unique_name;  ///< differs from `name` where several have that name
  std::string type;         ///< OpenVDB's: "Tree_float_5_4_3"
  std::string parent;       ///< unique name of the grid whose tree it shares; empty where it has its own
  std::size_t begin = 0;    ///< where its content begins and ends in the file
  std::size_t end = 0;
};

struct VdbLayout {
  bool is_sealed = false;  ///< carries a checksum of the whole, which holds
  std::vector<VdbGrid> grids;
};

constexpr std::string_view kFloatGridType = "Tree_float_5_4_3";
constexpr std::string_view kMaskGridType = "Tree_mask_5_4_3";

/// Checks a file's checksum, where seal_vdb() gave it one, and its head. Metadata that OpenVDB would unpack without
/// looking at its sizes are renamed in `bytes`, so that it skips them, and a format that OpenVDB 10 warns of is
/// lowered. A file written without places to jump to, as into a pipe, is looked through as check_vdb_grid() does.
/// Throws Error on a file that is damaged, is none, is older than OpenVDB 2 (format 222), or newer than OpenVDB 13
/// (225).
VdbLayout check_vdb(std::string& bytes);

/// Walks through a grid of floats or a mask, or one that shares such a tree, as OpenVDB's reader will: each count, size
/// and place must be as its writer makes them and lie within the file, so that reading takes memory in proportion to
/// the file. Renames metadata as check_vdb() does. Throws Error on a damaged grid, one of another type, with
/// perspective, or with over 2^27 voxels in active tiles.
void check_vdb_grid(std::string& bytes, const VdbGrid& grid);

/// Puts a checksum of a whole file's bytes where OpenVDB puts a random tag, in the form of a UUID of version 8
/// (RFC 9562): any OpenVDB program reads the file, and one that writes it anew gives it a random tag again. Equal
/// content makes equal files so. Throws Error where the head is not as OpenVDB 10 writes it.
void seal_vdb(std::string& bytes);

}  // namespace spinaltap::detail

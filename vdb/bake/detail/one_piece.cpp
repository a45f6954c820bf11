#include "vdb/bake/detail/one_piece.h"

#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <array>
#include <vector>

namespace spinaltap::detail {
namespace {

using openvdb::Coord;

/// Drops what is left of the band without any surface.
openvdb::FloatGrid::Ptr without_specks(const openvdb::FloatGrid::Ptr& grid) {
  std::vector<openvdb::FloatGrid::Ptr> pieces;
  openvdb::tools::segmentSDF(*grid, pieces);
  if (pieces.size() < 2) return grid;
  openvdb::FloatGrid::Ptr largest = *std::max_element(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) {
    return a->activeVoxelCount() < b->activeVoxelCount();
  });
  openvdb::tools::signedFloodFill(largest->tree());
  return largest;
}

constexpr std::array<std::array<int, 3>, 6> kFaces{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

/// Gives the voxels of a piece to the other side, and takes its surface away: voxels of that side around it are no
/// longer near a surface, but for those that touch another.
void give_away(openvdb::FloatGrid& grid, const std::vector<Coord>& piece, float other_side) {
  constexpr int kBand = 3;
  auto accessor = grid.getAccessor();
  for (const Coord& at : piece) accessor.setValueOff(at, other_side);
  for (const Coord& at : piece) {
    const openvdb::CoordBBox around(at.offsetBy(-kBand), at.offsetBy(kBand));
    for (auto near = around.begin(); near; ++near) {
      if (!accessor.isValueOn(*near) || accessor.getValue(*near) * other_side < 0.0F) continue;
      const bool touches = std::any_of(kFaces.begin(), kFaces.end(), [&](const auto& face) {
        return accessor.getValue((*near).offsetBy(face[0], face[1], face[2])) * other_side < 0.0F;
      });
      if (!touches) accessor.setValueOff(*near, other_side);
    }
  }
}

std::vector<Coord> voxels_of(const openvdb::BoolGrid& mask) {
  std::vector<Coord> voxels;
  for (auto voxel = mask.cbeginValueOn(); voxel; ++voxel) voxels.push_back(voxel.getCoord());
  return voxels;
}

/// Drops all solids but the largest; returns how many.
std::size_t drop_other_solids(openvdb::FloatGrid& grid) {
  const openvdb::BoolGrid::Ptr interior = openvdb::tools::sdfInteriorMask(grid);
  interior->tree().voxelizeActiveTiles();
  std::vector<openvdb::BoolGrid::Ptr> solids;  // the largest first
  openvdb::tools::segmentActiveVoxels(*interior, solids);
  for (std::size_t n = 1; n < solids.size(); ++n) give_away(grid, voxels_of(*solids[n]), grid.background());
  return solids.empty() ? 0 : solids.size() - 1;
}

/// Fills cavities: no part of a bone's surface lies within it. Returns how many.
std::size_t fill_cavities(openvdb::FloatGrid& grid) {
  const openvdb::BoolGrid::Ptr shells = openvdb::BoolGrid::create(false);
  auto shell = shells->getAccessor();
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) {
    if (*voxel >= 0.0F) shell.setValueOn(voxel.getCoord(), true);
  }
  std::vector<openvdb::BoolGrid::Ptr> spaces;  // the one around the bone first, as the largest
  openvdb::tools::segmentActiveVoxels(*shells, spaces);
  const auto value = grid.getConstAccessor();
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  std::size_t cavities = 0;
  for (std::size_t n = 1; n < spaces.size(); ++n) {
    std::vector<Coord> cavity = voxels_of(*spaces[n]);
    const auto is_bone = [&](const Coord& at) { return value.getValue(at) < 0.0F; };
    const bool has_wall = std::any_of(cavity.begin(), cavity.end(), [&](const Coord& at) {
      return std::any_of(kFaces.begin(), kFaces.end(),
                         [&](const auto& face) { return is_bone(at.offsetBy(face[0], face[1], face[2])); });
    });
    if (!has_wall) continue;
    // What lies within its shell, where nothing is near the surface.
    auto known = spaces[n]->getAccessor();
    bool is_open = false;
    for (std::size_t at = 0; at < cavity.size() && !is_open; ++at) {
      for (const auto& face : kFaces) {
        const Coord next = cavity[at].offsetBy(face[0], face[1], face[2]);
        if (known.isValueOn(next) || is_bone(next)) continue;
        is_open = is_open || !box.isInside(next);
        known.setValueOn(next, true);
        cavity.push_back(next);
      }
    }
    if (is_open) continue;
    give_away(grid, cavity, -grid.background());
    ++cavities;
  }
  return cavities;
}

}  // namespace

std::size_t keep_one_piece(openvdb::FloatGrid::Ptr& grid) {
  const std::size_t solids = drop_other_solids(*grid);
  const std::size_t cavities = fill_cavities(*grid);
  grid = without_specks(grid);
  return solids + cavities;
}

}  // namespace spinaltap::detail

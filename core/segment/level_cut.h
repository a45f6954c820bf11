#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/segment/bone_levels.h"
#include "core/segment/vertebra_markers.h"

namespace spinaltap {

/// What a block's blurred CT number says of bone that was found there.
enum class Brightness : std::uint8_t {
  kDim,     ///< too dark for bone beside what is as dense: its blur
  kBone,    ///< bone, or soft tissue
  kCement,  ///< 900 HU and more
  kMetal,   ///< 2500 HU and more
};

/// The part of a CT in which one vertebra is parted from its neighbours, in steps of about 0.8 mm, and what the walker
/// found there. Boxes of all levels of a CT lie on one lattice of blocks, so that their voxels can be compared.
struct LevelCut {
  VoxelBox box;  ///< of the CT; begins at a multiple of `bins`
  std::array<int, 3> bins{1, 1, 1};
  GridGeometry geometry;  ///< of its blocks
  std::vector<Brightness> brightness;
  std::vector<float> peak_hu;           ///< the greatest within 1.6 mm
  std::vector<float> depth_mm;          ///< in the vertebra's body
  std::vector<std::uint8_t> bone;       ///< all bone, neighbours included
  std::vector<std::uint8_t> ribs;       ///< what goes on sideways beyond any process
  std::vector<WalkerVoxel> markers;     ///< what was known before the walk
  std::vector<std::size_t> given_away;  ///< bone that a user gave to others
  std::vector<float> conductivity;      ///< of the walker's steps, 0 to 1: little in gaps between bones
  std::vector<float> probability;       ///< that a walker from here meets the vertebra's body first

  /// Frees all that its neighbours do not ask for.
  void keep_probability_only();
};

/// Voxels of a CT that a user gave to one body of a row, or to none of them.
struct MarkedVoxels {
  std::optional<std::size_t> body;   ///< index in the row; nothing: no vertebra's
  std::vector<std::size_t> offsets;  ///< in the CT's grid
};

/// Parts one vertebra from its neighbours: bone is what lies over a threshold, with hysteresis, what it encloses, and
/// the insides of the bodies; a random walker shares it out (see random_walker.h, vertebra_markers.h). `marks` overrule
/// what anatomy says.
LevelCut cut_level(const CtVolume& ct, const BoneLevels& levels, const BodyInRow& row,
                   const std::vector<MarkedVoxels>& marks = {});

/// A bone at a vertebra's side that a joint parts from it: a rib too short to be known by its length.
struct SideBone {
  std::vector<std::size_t> voxels;  ///< of the cut; empty where there is no joint
  double sharpness = 1.0;           ///< share of the piece over which a walker's chances turn: small at a joint
};

/// Looks at what the vertebra (`mine`) has at its left (1) or right (-1) side beyond its body. A walker between its
/// outermost end and the vertebra's own markers changes his mind in a joint's gap where there is one, and all along a
/// transverse process.
SideBone find_side_bone(const LevelCut& cut, const std::vector<std::uint8_t>& mine, const BodyCylinder& body,
                        double side);

/// The vertebra on the CT's grid, from the voxels that are its own: the rim that is only blur is taken off, pits are
/// filled, pieces that hang on nothing are dropped, and each voxel's own CT number decides where the CT is finer than
/// the work. Empty where nothing is left.
struct FinishedLevel {
  std::vector<std::uint8_t> blocks;  ///< the cut's voxels that are the vertebra's
  std::vector<std::uint8_t> inside;  ///< within `box` of the CT
  VoxelBox box;
  std::size_t parts_dropped = 0;
};
FinishedLevel finish_level(const LevelCut& cut, std::vector<std::uint8_t> mine, const std::vector<std::uint8_t>& others,
                           const CtVolume& ct, const BoneLevels& levels);

/// Area of the faces between the vertebra and other bone, mm².
double cut_area_mm2(const LevelCut& cut, const std::vector<std::uint8_t>& mine);

}  // namespace spinaltap

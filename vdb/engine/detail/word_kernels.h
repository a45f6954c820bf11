#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spinaltap::detail {

/// A tool in float, as leaves of voxels are looked at: bounds as ToolBounds has them.
struct WordTool {
  static constexpr std::size_t kMaxPieces = 16;
  struct Piece {
    float begin, end;
    float ball_centre, ball_radius;  ///< radius 0: a frustum
    float per_off, per_back, at_origin;
  };
  Piece pieces[kMaxPieces];
  std::size_t piece_count;
  float radius, cone_offset, cone_slope;
  float skin;   ///< by which the outline that is swept is larger
  float spare;  ///< what rounding may hide, mm
};

/// How a word's voxels lie to its first, seen from the tool: two directions across its axis, and back along it; mm. The
/// same for all words of a step.
struct WordOffsets {
  alignas(64) float of_bits[3][64];
};

/// Where a leaf's voxels lie, seen from the tool: as SweptBit sees them.
struct LeafPlace {
  const WordOffsets* offsets;
  float first[3];  ///< of the voxel of the first word's bit 0
  float per_x[3];  ///< a word further
};

/// What a word of 64 voxels came to.
struct WordResult {
  std::uint64_t unsure;  ///< of the living: the tool may have reached them
  std::uint64_t dead;    ///< the tool holds them at the end of its way, or passed them
  // Least bounds of the other living voxels; 1e15 or more without any. Of `pieces` alone where that is one.
  float cylinder, cone, body;
};

struct LeafArguments {
  static constexpr std::size_t kMostPieces = 4;
  const WordTool* tool;
  LeafPlace places[kMostPieces + 1];  ///< at the begin of the tool's way and after each of its pieces
  unsigned piece_count;               ///< of the way
  float cylinder, cone, body, piece;  ///< how near a voxel's lower bounds must be, see SweptBounds::Reach
  unsigned pieces;                    ///< bit n: piece n may have come near; one at least
  bool wants_cylinder;                ///< else any bound of it will do
  float rest;                         ///< the leaf's least bound from the others
  const std::uint64_t* words;
  unsigned due;  ///< bit x: look at word x
};

/// One set of instructions. All sets do the same operations: their results are the same bits.
struct WordKernels {
  const char* name;
  void (*look)(const LeafArguments& leaf, WordResult* words);

  // Of machines that are no x86 the first alone.
  static WordKernels portable();
  static WordKernels avx2();
  static WordKernels avx512();
};

/// The sets that this machine can run; portable ones first, the fastest last.
const std::vector<WordKernels>& word_kernels();

}  // namespace spinaltap::detail

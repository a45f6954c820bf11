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
  std::uint64_t unsure;        ///< of the occupied: the tool may have reached them
  std::uint64_t dead;          ///< the tool holds them at the end of its way
  float cylinder, cone, body;  ///< least bounds of the other occupied voxels; 1e15 or more without any
};

struct LeafArguments {
  static constexpr std::size_t kMostPieces = 4;
  const WordTool* tool;
  LeafPlace places[kMostPieces + 1];  ///< at the begin of the tool's way and after each of its pieces
  unsigned piece_count;               ///< of the way
  float cylinder, cone, body, piece;  ///< how near a voxel's lower bounds must be, see SweptBounds::Reach
  unsigned pieces;                    ///< bit n: piece n may have come near; one at least
  float rest;                         ///< the leaf's least bound from the others
  const std::uint64_t* words;
};

/// A ball or a cylinder without ends, as a leaf's voxels are put to it; all in voxels. Rows are the voxels along z, or
/// along y, with y and z swapped in what is given: along an axis a cylinder's square does not bend.
struct RoundPlace {
  float first[3];   ///< the leaf's first voxel from the ball's centre, or from a place on the cylinder's axis near by
  float axis[3];    ///< unit, from the base to the tip
  float low, high;  ///< how far along the axis from that place the piece reaches
};

struct RowArguments {
  static constexpr std::size_t kMostPlaces = LeafArguments::kMostPieces + 1;
  bool is_ball;
  bool along_y;
  bool has_ends;                   ///< some of the leaf may lie beyond low or high
  RoundPlace places[kMostPlaces];  ///< at the end of the tool's way, and at other moments of it
  unsigned place_count;
  float in_square, out_square;  ///< of the distance from a place that holds surely, and that may have been reached
  float tolerance;              ///< of a place along a row
  const std::uint64_t* words;
};

/// One set of instructions. All sets do the same operations: their results are the same bits.
struct WordKernels {
  const char* name;
  void (*look_at_words)(const LeafArguments& leaf, WordResult* words);
  /// Adds to `dead` the occupied voxels that a place surely holds, to `unsure` others that may have been reached. Gives
  /// the least square of all other occupied voxels' distance from the first place; 1e30 without any.
  float (*look_at_rows)(const RowArguments& rows, std::uint64_t* dead, std::uint64_t* unsure);

  // Of machines that are no x86 the first alone.
  static WordKernels portable();
  static WordKernels avx2();
  static WordKernels avx512();
};

/// The sets that this machine can run; portable ones first, the fastest last.
const std::vector<WordKernels>& word_kernels();

}  // namespace spinaltap::detail

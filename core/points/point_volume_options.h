#pragma once

#include <cstdint>

namespace spinaltap {

/// How exactly a point's CT number is stored.
enum class HuBits {
  eight,   ///< steps of 16 HU from -1024 to 3056
  sixteen  ///< whole HU
};

/// How a disc is divided into points.
enum class DiscSubdivision {
  rings,    ///< circles: the paper's choice, best for collision
  hexagons  ///< triangles of equal sides within a hexagon, whose flats lie nearer: the paper's first, for comparison
};

/// The cylinder of points that a session drills: PointVolume.
struct PointVolumeOptions {
  double radius_mm = 3.0;   ///< of the cylinder about the path; somewhat larger than the bit's
  double spacing_mm = 0.1;  ///< between discs, rings and, nearly, neighbours on a ring
  /// How far before the entry the cylinder starts, so that bone beside a slanting entry is in it.
  double lead_in_mm = 0.0;
  HuBits hu_bits = HuBits::sixteen;
  DiscSubdivision subdivision = DiscSubdivision::rings;
  /// Points are moved at random by up to this share of the spacing along each axis, at most 0.5 (the paper's section
  /// 6.4, against aliasing).
  double jitter = 0.0;
  std::uint64_t jitter_seed = 1;
};

}  // namespace spinaltap

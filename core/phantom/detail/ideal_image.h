#pragma once

#include <span>
#include <vector>

#include "core/phantom/scanner.h"

namespace spinaltap {

/// The image that a scanner without blur or noise would make, on a lattice of samples_per_pixel samples along each side
/// of a pixel and samples_per_step planes a slice step. Only a stack of planes, and of these only the part that the
/// solid's bounds touch, is held at a time. Values are HU above the surroundings, 0 outside the part that is held.
class IdealImage {
 public:
  /// `geometry`: of the scan. Keeps references.
  /// `surroundings`: null for the even ones of `options`.
  IdealImage(const Solid& solid, const GridGeometry& geometry, const ScanOptions& options,
             const Surroundings* surroundings = nullptr);

  /// Makes planes begin ... end - 1 available, keeping what was held of them. Plane 0 is that of slice 0.
  void hold(int begin, int end);

  /// Values of a held plane: height() rows of width() samples.
  std::span<const float> plane(int index) const;

  int first_column() const { return first_[0]; }
  int first_row() const { return first_[1]; }
  int width() const { return size_[0]; }
  int height() const { return size_[1]; }

 private:
  /// Samples [low, high) of the held part, by column, row and plane.
  struct Block {
    std::array<int, 3> low, high;
  };

  void fill(const Block& block);
  Vec3 position_mm(double column, double row, double plane) const;
  std::size_t offset(int column, int row, int plane) const;

  const Solid& solid_;
  const ScanOptions& options_;
  const Surroundings* surroundings_;
  Vec3 origin_mm_, step_mm_;  ///< of the lattice; sample (0, 0, 0) is the corner sample of the scan
  double cell_mm_;            ///< side of a cube of a lattice cell's volume
  std::array<int, 2> first_{}, size_{};
  int held_begin_ = 0, held_end_ = 0;
  std::vector<float> values_;
};

}  // namespace spinaltap

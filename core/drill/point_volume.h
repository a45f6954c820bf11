#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/drill/disc_pattern.h"
#include "core/drill/drill_path.h"
#include "core/drill/path_frame.h"

namespace spinaltap {

struct PointVolumeOptions {
  double radius_mm = 3.0;   ///< of the cylinder; somewhat larger than the bit's
  double spacing_mm = 0.1;  ///< between discs, rings and, nearly, neighbours on a ring
  /// How far before the entry the cylinder starts, so that bone beside a slanting entry is in it.
  double lead_in_mm = 0.0;
};

/// The cylinder of discs of rings of points that a bit decimates (the paper's section 6). A point's position follows
/// from its indices; what is stored of it is whether it is alive, and its CT number.
class PointVolume {
 public:
  /// A cylinder along the path, every point alive and of 0 HU. Discs: (lead-in + path length) / spacing, rounded.
  /// Throws Error on absurd sizes (over 2^32 points).
  PointVolume(const DrillPath& path, const PointVolumeOptions& options);

  const PathFrame& frame() const { return frame_; }
  const DiscPattern& pattern() const { return pattern_; }
  int disc_count() const { return disc_count_; }
  std::size_t point_count() const { return alive_.size(); }
  std::size_t alive_count() const;
  double lead_in_mm() const { return lead_in_mm_; }

  /// Distance of a disc from the volume's start along the path, mm.
  double disc_depth_mm(int disc) const { return disc * pattern_.spacing_mm(); }
  std::size_t disc_start(int disc) const { return static_cast<std::size_t>(disc) * pattern_.point_count(); }
  /// Position in path-local coordinates, mm.
  Vec3 point_in_path_mm(int disc, std::size_t index_in_disc) const {
    const Eigen::Vector2d& p = pattern_.point_mm(index_in_disc);
    return {p.x(), p.y(), disc_depth_mm(disc)};
  }

  std::span<const std::uint8_t> alive() const { return alive_; }
  std::span<std::uint8_t> alive() { return alive_; }
  std::span<const std::int16_t> hu() const { return hu_; }
  std::span<std::int16_t> hu() { return hu_; }

 private:
  PathFrame frame_;
  DiscPattern pattern_;
  int disc_count_ = 0;
  double lead_in_mm_ = 0.0;
  std::vector<std::uint8_t> alive_;
  std::vector<std::int16_t> hu_;
};

/// What fills a volume: for patient positions (mm), the signed distance to the bone's surface (mm, negative inside) and
/// the CT number (HU). Called from many threads at once.
using BoneSampler =
    std::function<void(std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu)>;

/// Kills every point outside the bone and gives the others their CT number (the paper's section 6.3). Points whose
/// distance is not a number die. Throws Error when the CT number of a point inside is not a number.
void fill_volume(PointVolume& volume, const BoneSampler& bone, const Progress& progress = {});

}  // namespace spinaltap

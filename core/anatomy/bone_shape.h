#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/anatomy/point_tree.h"
#include "core/base/progress.h"
#include "core/base/scalar_field.h"
#include "core/segment/float_grid.h"

namespace spinaltap {

/// A bone's shape as planning sees it: its surface as many points, and signed distances (mm, negative inside) to it
/// from anywhere, not only from the narrow band that a baked grid keeps.
class BoneShape {
 public:
  static constexpr double kLatticeMm = 0.5;
  /// About how far the points of the surface lie from each other.
  static constexpr double kSampleMm = 0.5 * kLatticeMm;

  /// `surface`: its value is the distance up to `trusted_band_mm` from its zero set, has the right sign everywhere, and
  /// its gradient leads to the zero set from 0.5 mm away. `bounds_mm` holds the zero set. Throws Error where there is
  /// none, and on boxes of over 0.5 m.
  BoneShape(std::shared_ptr<const ScalarField> surface, const Box3& bounds_mm, double trusted_band_mm,
            const Progress& progress = {});

  /// Points of the surface: every place of it has one within 0.25 mm, most within 0.15 mm.
  const std::vector<Vec3>& points_mm() const { return tree_.points_mm(); }
  /// Of each of points_mm(): unit, outward.
  const std::vector<Vec3>& normals() const { return normals_; }
  /// Smallest box around points_mm().
  const Box3& bounds_mm() const { return bounds_mm_; }

  /// Signed distance to the surface, right to about 0.02 mm.
  double distance_mm(const Vec3& p_mm) const;
  bool is_inside(const Vec3& p_mm) const;
  /// The nearest of points_mm().
  PointTree::Nearest nearest(const Vec3& p_mm) const { return tree_.nearest(p_mm); }
  /// Of points_mm().
  const PointTree& tree() const { return tree_; }

  /// Distances at voxels of kLatticeMm around the bone: inside as distance_mm(), deeper than 3 mm up to 0.1 mm more;
  /// outside at least the right sign. For searches.
  const FloatGrid& lattice() const { return lattice_; }
  /// Tri-linear value of the lattice; beyond it, its border's.
  double lattice_mm(const Vec3& p_mm) const {
    return sample_clamped(lattice_, (p_mm - lattice_.geometry.origin_mm) / kLatticeMm);
  }

  const ScalarField& surface() const { return *surface_; }
  /// Up to here from its zero set the surface's value is the distance.
  double trusted_band_mm() const { return trusted_band_mm_; }

 private:
  std::shared_ptr<const ScalarField> surface_;
  double trusted_band_mm_;
  FloatGrid lattice_;
  std::vector<Vec3> normals_;
  PointTree tree_;
  Box3 bounds_mm_;
};

/// Distance from p to a surface of which `nearest_mm` is the nearest known point, at `distance_mm`, and `normal` the
/// normal there: without what the point lies beside the foot of p, up to `spacing_mm`.
double without_sampling_error_mm(const Vec3& p_mm, const Vec3& nearest_mm, const Vec3& normal, double spacing_mm);

}  // namespace spinaltap

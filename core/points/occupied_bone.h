#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/points/material.h"
#include "core/tool/bit_profile.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

class PointVolume;

/// The occupied bone that a tool works in, as forces and sessions ask of it, whatever it is kept in. Places are in its
/// own frame() where not said otherwise.
class OccupiedBone {
 public:
  /// What a material makes of the bone at a place.
  struct Bone {
    double density_g_cm3 = 0.0;
    double chisel_mpa = 0.0;
    double contact_n_mm = 0.0;  ///< of a surface as large as the bit's section
  };
  /// What it makes of each CT number of a range.
  class Table {
   public:
    Table() = default;
    /// Throws Error on a bad material.
    Table(const Material& material, std::pair<int, int> hu_range);
    const Bone& of(int hu) const noexcept { return bones_[static_cast<std::size_t>(hu - lowest_hu_)]; }

   private:
    int lowest_hu_ = 0;
    std::vector<Bone> bones_;
  };
  /// A mean over bone and what is missing of it, which counts as bone of no density.
  struct Mean {
    double density_g_cm3 = 0.0;
    double chisel_mpa = 0.0;

    void add(const Bone* bone, double share) noexcept {
      if (bone == nullptr) return;
      density_g_cm3 += share * bone->density_g_cm3;
      chisel_mpa += share * bone->chisel_mpa;
    }
  };

  OccupiedBone() = default;
  OccupiedBone(const OccupiedBone&) = delete;
  OccupiedBone& operator=(const OccupiedBone&) = delete;
  virtual ~OccupiedBone() = default;

  virtual const PathFrame& frame() const = 0;
  virtual bool has_occupied() const = 0;
  /// Between neighbours, where they are widest apart.
  virtual double widest_spacing_mm() const = 0;
  /// Between neighbours at a place.
  virtual double spacing_mm(const Vec3& p) const noexcept = 0;

  /// What the bone nearest to `p` is made of; null where it is dead or none is known.
  virtual const Bone* occupied_at(const Vec3& p) const noexcept = 0;
  /// Adds the bone just ahead of a place that goes along `axis`, as smooth as the bone is.
  virtual void add_ahead_of(const Vec3& p, const Vec3& axis, double share, Mean& mean) const noexcept = 0;
  /// The volume whose discs lie across z there; null where bone is not kept in discs.
  virtual const PointVolume* discs_at(double z_mm) const noexcept = 0;

  /// Throws Error where a path leaves what is known.
  virtual void check_within(const DrillPath& path) const = 0;
  /// How far a tip has gone past the end of what is known, mm, patient LPS; negative: how far before.
  virtual double past_end_mm(const Vec3& tip_mm) const noexcept = 0;
  /// How far the part of a bit that lies deeper than its tip did at the first contact reaches out of the side of what
  /// is known, mm, patient LPS; negative: how much room there is.
  virtual double beyond_side_mm(const BitProfile& bit, const Pose& pose, const Vec3& contact_mm) const noexcept = 0;
};

}  // namespace spinaltap

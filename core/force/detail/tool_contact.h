#pragma once

#include <array>
#include <vector>

#include "core/force/detail/contact_stiffness_sum.h"
#include "core/points/occupied_bone.h"
#include "core/tool/bit_profile.h"
#include "core/tool/plate.h"

namespace spinaltap {

/// Bone that pushes a bit back which touches it without cutting. Places on the bit's surface, each for its share of the
/// surface over the bit's section, are pushed inwards by the stiffness of the bone there times how deep it lies in
/// bone.
class ToolContact {
 public:
  /// Throws Error on a bad bit.
  ToolContact(const OccupiedBone& bone, const DrillBit& bit);

  /// Force on the bit, N; `pose` and force in the bone's coordinates. `stiffness`, where it is given, has its part
  /// added.
  Vec3 contact_n(const Pose& pose, ContactStiffnessSum* stiffness = nullptr) const noexcept;
  std::size_t place_count() const { return places_.size(); }

 private:
  struct Place {
    double back_mm = 0.0;
    double across_x_mm = 0.0, across_y_mm = 0.0;
    double normal_back = 0.0;  ///< outward, unit
    double normal_x = 0.0, normal_y = 0.0;
    double share = 0.0;   ///< of the surface, over the bit's section
    double max_mm = 0.0;  ///< how far inwards bone may lie: to the axis, or the middle
  };
  void add_body(const BitProfile& profile, double radius_mm);
  void add_ring(double back_mm, double radius_mm, double normal_back, double normal_off, double area_mm2);
  void add_box(const PlateBox& box);
  double depth_mm(const Vec3& p, const Vec3& inward, double max_mm) const noexcept;

  const OccupiedBone* bone_;
  double section_mm2_;
  bool is_plate_;
  std::vector<Place> places_;
};

/// The bone just ahead of a bit's chisel edge, as smooth as the bone is.
class ChiselProbe {
 public:
  /// `edge_radius_mm`: of the disc that the chisel edge turns over.
  ChiselProbe(const OccupiedBone& bone, double edge_radius_mm) : bone_(&bone), edge_radius_mm_(edge_radius_mm) {}
  /// Ahead of a plate's edge, of all its width.
  static ChiselProbe of_edge(const OccupiedBone& bone, double width_mm) {
    ChiselProbe probe(bone, 0.0);
    probe.width_mm_ = width_mm;
    return probe;
  }

  /// `pose` in the bone's coordinates.
  OccupiedBone::Mean ahead_of(const Pose& pose) const noexcept;

 private:
  const OccupiedBone* bone_;
  double edge_radius_mm_;
  double width_mm_ = 0.0;  ///< 0: not of a plate
};

}  // namespace spinaltap

#pragma once

#include <openvdb/tools/Interpolation.h>

#include <limits>
#include <optional>

#include "vdb/detail/bone_grids.h"
#include "vdb/picture/detail/surface_crossing.h"
#include "vdb/picture/render.h"

namespace spinaltap::detail {

/// What rays meet of a bone: its surface before it was drilled, and that of the hole in its grids. Each
/// keeps its own surface, so that the rim between them is sharp.
struct DrawnBone {
  BoneModel bone;  ///< before it was drilled
  openvdb::FloatGrid::ConstPtr bone_grid;
  openvdb::FloatGrid::ConstPtr hole_grid;  ///< null where nothing was drilled
  openvdb::CoordBBox bone_box;
  std::optional<openvdb::CoordBBox> hole_box = {};  ///< none where there is no hole

  explicit DrawnBone(const BoneModel& its_bone);
  /// Another hole in it.
  DrawnBone(const BoneModel& its_bone, openvdb::FloatGrid::ConstPtr hole);
};

/// One thread's rays into a bone, one after the other.
class BoneRay {
 public:
  static constexpr double kMissed = std::numeric_limits<double>::infinity();

  /// What a ray goes through, into what is left of the bone or out of it.
  enum class Kind { bone, wall, cut };
  struct Surface {
    double way_mm = kMissed;
    Kind kind = Kind::bone;
  };

  explicit BoneRay(const DrawnBone& bone, const std::optional<CutPlane>& cut = {});

  /// A ray (patient LPS, mm; unit direction) from there on, or from where it goes through the cut; `is_in_bone`: what
  /// is left of it is there.
  void begin(const Vec3& start_mm, const Vec3& direction, bool is_in_bone);
  /// The next surface, which is not met again; kMissed after the last.
  Surface next_surface();
  /// Whether there is bone just behind the last surface.
  bool is_in_bone() const { return is_in_bone_; }
  /// The place of a surface from next_surface(), to 1e-5 mm where the bone or the hole is not just grazed.
  double refined_mm(const Surface& surface);

  /// Distance to the bone's own surface.
  double bone_mm(const Vec3& p_mm);
  /// Of what is left of the bone, mm, negative within.
  double distance_mm(const Vec3& p_mm);
  /// Unit, out of what is left of the bone, at a place of its surface; against the ray where it has none.
  Vec3 normal(const Vec3& p_mm, Kind kind);

 private:
  using Sampler = openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::BoxSampler>;

  double hole_mm(const Vec3& p_mm) { return static_cast<double>(hole_.wsSample(to_vdb(p_mm))); }
  double next_crossing_mm(SurfaceCrossing& surface, double begin_mm) const;
  void find_hole(double begin_mm);
  Vec3 at(double way_mm) const { return start_mm_ + way_mm * direction_; }

  const DrawnBone& drawn_;
  SurfaceCrossing to_bone_;
  std::optional<SurfaceCrossing> to_hole_;
  openvdb::FloatGrid::ConstAccessor hole_accessor_;
  Sampler hole_;
  std::optional<CutPlane> cut_;
  double step_mm_;

  Vec3 start_mm_ = Vec3::Zero();
  Vec3 direction_ = Vec3::UnitX();
  double bone_crossing_mm_ = 0.0;  ///< where the ray next goes through the surface; kMissed: nowhere
  double hole_crossing_mm_ = 0.0;
  /// Not looked for before it is asked for: from here on; below 0: found.
  double find_bone_from_mm_ = -1.0;
  double find_hole_from_mm_ = -1.0;
  bool knows_hole_ = false;  ///< not looked for before the ray is in the bone as it was
  double passed_mm_ = 0.0;   ///< just behind the last surface
  double begin_mm_ = 0.0;    ///< of the ray that is seen: from here
  double end_mm_ = 0.0;      ///< to here
  bool is_in_bone_ = false;
};

}  // namespace spinaltap::detail

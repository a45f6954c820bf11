#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

class BoneShape;
class VertebraParts;
struct Landmarks;

/// How far a place is from the vertebra's outer surface and from the canal: positive in the bone, negative by how far
/// it is beyond that surface. Beyond the one, the other is still positive. Safe to ask from many threads.
class WallDistance {
 public:
  /// `bone` and `landmarks`, which must be its own, must outlive this. Throws Error where the landmarks do not flag as
  /// many points as the bone has.
  WallDistance(const BoneShape& bone, const Landmarks& landmarks);
  ~WallDistance();
  WallDistance(WallDistance&&) noexcept;

  struct Wall {
    double distance_mm = 0.0;        ///< signed; infinite where the bone has no such wall
    Vec3 nearest_mm = Vec3::Zero();  ///< place of the wall, to about 0.2 mm the nearest, patient LPS
    Vec3 normal = Vec3::Zero();      ///< there: unit, out of the bone; zero where there is no wall
    std::size_t sample = std::numeric_limits<std::size_t>::max();  ///< the nearest: where the next search begins
  };
  struct Walls {
    Wall outer, canal;
    /// To the bone's surface: negative where the place is not in the bone.
    double nearer_mm() const { return std::min(outer.distance_mm, canal.distance_mm); }
  };
  /// The wall near a sample of it, as a plane: its distance without sign, and the foot of p on it.
  static Wall wall_at(const Vec3& p_mm, const Vec3& sample_mm, const Vec3& normal);
  /// Both at one go, for little more than one. Right to about 0.02 mm. Not a number where the position is not.
  Walls walls(const Vec3& p_mm) const { return walls(p_mm, Walls{}); }
  /// The same, sooner where `beside` are those of a place close by.
  Walls walls(const Vec3& p_mm, const Walls& beside) const;
  /// The canal's or the outer one of walls(), sooner, where the other one is nearer for sure.
  Wall further(const Vec3& p_mm, bool is_canal, const Wall& beside) const {
    return nearest(is_canal ? *canal_ : *outer_, p_mm, beside.sample);
  }
  Wall outer(const Vec3& p_mm) const { return walls(p_mm).outer; }
  /// Quicker than walls() in the bone.
  Wall canal(const Vec3& p_mm) const;

  /// Which wall a place is beyond, and how far.
  struct Beyond {
    double distance_mm = 0.0;  ///< from the bone; 0 in it
    bool is_canal = false;     ///< beyond the canal's wall
    Wall wall;                 ///< where distance_mm is above 0: what it is beyond
  };
  Beyond beyond(const Vec3& p_mm) const { return beyond(p_mm, Beyond{}); }
  /// The same, sooner where `beside` is that of a place close by; distances up to `least_mm` may be told as 0.
  Beyond beyond(const Vec3& p_mm, const Beyond& beside, double least_mm = 0.0) const;

  /// The same of a place out of the bone whose nearest point of the bone's surface is known, and the surface's value.
  Beyond beyond_sample(const Vec3& p_mm, double value_mm, std::size_t sample) const;

  const BoneShape& bone() const { return bone_; }
  const Landmarks& landmarks() const { return landmarks_; }
  const VertebraParts& parts() const { return *parts_; }

 private:
  /// The samples of one wall.
  struct Samples;
  static Wall nearest(const Samples& samples, const Vec3& p_mm, std::size_t guess);
  static std::unique_ptr<const Samples> samples_of(const BoneShape& bone, const Landmarks& landmarks, bool is_canal);

  const BoneShape& bone_;
  const Landmarks& landmarks_;
  std::unique_ptr<const VertebraParts> parts_;
  std::unique_ptr<const Samples> outer_, canal_;
};

}  // namespace spinaltap

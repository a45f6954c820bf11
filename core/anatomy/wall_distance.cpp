#include "core/anatomy/wall_distance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/landmarks.h"
#include "core/anatomy/vertebra_parts.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

double surface_value_mm(const BoneShape& bone, const Vec3& p_mm) {
  double value_mm = 0.0;
  bone.surface().evaluate({&p_mm, 1}, {&value_mm, 1}, {});
  return value_mm;
}

}  // namespace

struct WallDistance::Samples {
  PointTree tree;
  std::vector<Vec3> normals;
};

WallDistance::Wall WallDistance::wall_at(const Vec3& p_mm, const Vec3& sample_mm, const Vec3& normal) {
  Wall wall;
  wall.normal = normal;
  wall.nearest_mm = sample_mm;
  wall.distance_mm = without_sampling_error_mm(p_mm, sample_mm, normal, BoneShape::kSampleMm);
  const Vec3 foot_mm = p_mm - (p_mm - sample_mm).dot(normal) * normal;
  if ((foot_mm - sample_mm).norm() <= BoneShape::kSampleMm) wall.nearest_mm = foot_mm;
  return wall;
}

std::unique_ptr<const WallDistance::Samples> WallDistance::samples_of(const BoneShape& bone, const Landmarks& landmarks,
                                                                      bool is_canal) {
  const std::vector<std::uint8_t>& flags = landmarks.is_canal_wall;
  const auto count = static_cast<std::size_t>(
      std::count_if(flags.begin(), flags.end(), [&](std::uint8_t flag) { return (flag != 0) == is_canal; }));
  std::vector<Vec3> points_mm, normals;
  points_mm.reserve(count);
  normals.reserve(count);
  for (std::size_t n = 0; n < bone.points_mm().size(); ++n) {
    if ((landmarks.is_canal_wall[n] != 0) != is_canal) continue;
    points_mm.push_back(bone.points_mm()[n]);
    normals.push_back(bone.normals()[n]);
  }
  return std::make_unique<const Samples>(Samples{PointTree(std::move(points_mm)), std::move(normals)});
}

WallDistance::WallDistance(const BoneShape& bone, const Landmarks& landmarks)
    : bone_(bone), landmarks_(landmarks), parts_(std::make_unique<const VertebraParts>(bone, landmarks)) {
  if (landmarks.is_canal_wall.size() != bone.points_mm().size()) {
    fail("walls: expected landmarks of this bone, which flag its ", bone.points_mm().size(), " points, found ",
         landmarks.is_canal_wall.size(), " flags");
  }
  outer_ = samples_of(bone, landmarks, false);
  canal_ = samples_of(bone, landmarks, true);
}

WallDistance::~WallDistance() = default;
WallDistance::WallDistance(WallDistance&&) noexcept = default;

WallDistance::Wall WallDistance::nearest(const Samples& samples, const Vec3& p_mm, std::size_t guess) {
  const PointTree::Nearest found = samples.tree.nearest(p_mm, guess);
  Wall wall{std::numeric_limits<double>::infinity(), p_mm, Vec3::Zero()};
  if (found.index >= samples.normals.size()) return wall;
  wall = wall_at(p_mm, samples.tree.points_mm()[found.index], samples.normals[found.index]);
  wall.sample = found.index;
  return wall;
}

WallDistance::Wall WallDistance::canal(const Vec3& p_mm) const {
  // Deeper than the surface's value is sure, both walls are ahead, and none of them is nearer than that.
  if (surface_value_mm(bone_, p_mm) <= -bone_.trusted_band_mm()) return nearest(*canal_, p_mm, Wall{}.sample);
  return walls(p_mm).canal;
}

WallDistance::Walls WallDistance::walls(const Vec3& p_mm, const Walls& beside) const {
  Walls both;
  if (!p_mm.allFinite()) {
    both.outer.distance_mm = both.canal.distance_mm = std::numeric_limits<double>::quiet_NaN();
    return both;
  }
  both.outer = nearest(*outer_, p_mm, beside.outer.sample);
  both.canal = nearest(*canal_, p_mm, beside.canal.sample);
  Wall& nearer = both.canal.distance_mm < both.outer.distance_mm ? both.canal : both.outer;
  const double value_mm = surface_value_mm(bone_, p_mm);
  if (std::abs(value_mm) < bone_.trusted_band_mm()) nearer.distance_mm = std::abs(value_mm);
  if (value_mm > 0.0) nearer.distance_mm = -nearer.distance_mm;
  return both;
}

WallDistance::Beyond WallDistance::beyond(const Vec3& p_mm, const Beyond& beside, double least_mm) const {
  const std::size_t guess = beside.wall.sample;
  Beyond result;
  result.wall.sample = guess;
  const double value_mm = surface_value_mm(bone_, p_mm);
  if (!(value_mm > 0.0)) return result;
  double most_mm = value_mm;
  if (value_mm >= bone_.trusted_band_mm()) {
    most_mm = guess < bone_.points_mm().size() ? (p_mm - bone_.points_mm()[guess]).norm()
                                               : std::numeric_limits<double>::infinity();
  }
  if (most_mm <= least_mm) return result;
  const PointTree::Nearest found = bone_.tree().nearest(p_mm, guess);
  return found.index < bone_.normals().size() ? beyond_sample(p_mm, value_mm, found.index) : result;
}

WallDistance::Beyond WallDistance::beyond_sample(const Vec3& p_mm, double value_mm, std::size_t sample) const {
  Beyond result;
  result.is_canal = landmarks_.is_canal_wall[sample] != 0;
  result.wall = wall_at(p_mm, bone_.points_mm()[sample], bone_.normals()[sample]);
  result.wall.sample = sample;
  result.distance_mm = value_mm < bone_.trusted_band_mm() ? value_mm : result.wall.distance_mm;
  result.wall.distance_mm = -result.distance_mm;
  return result;
}

}  // namespace spinaltap

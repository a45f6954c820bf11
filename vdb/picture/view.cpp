#include "vdb/picture/view.h"

#include <tbb/parallel_for.h>

#include "vdb/picture/detail/bone_ray.h"
#include "vdb/picture/detail/drawn_solid.h"

namespace spinaltap {
namespace {

using detail::BoneRay;
using detail::DrawnSolid;

struct Hit {
  double way_mm = 0.0;
  Seen seen = Seen::nothing;
  Vec3 normal = Vec3::Zero();
};

Hit first_hit(BoneRay& ray, const std::optional<DrawnSolid>& bit, const Vec3& eye_mm, const Vec3& direction,
              bool is_in_bone) {
  const double bit_mm = bit ? bit->way_mm(eye_mm, direction) : DrawnSolid::kMissed;
  ray.begin(eye_mm, direction, is_in_bone);
  BoneRay::Surface surface = ray.next_surface();
  while (surface.way_mm < bit_mm && !ray.is_in_bone()) surface = ray.next_surface();
  if (surface.way_mm < bit_mm) {
    const double way_mm = ray.refined_mm(surface);
    const Seen seen = surface.kind == BoneRay::Kind::wall ? Seen::wall : Seen::bone;
    return {way_mm, seen, ray.normal(eye_mm + way_mm * direction, surface.kind)};
  }
  if (bit_mm < DrawnSolid::kMissed) return {bit_mm, Seen::bit, bit->normal(eye_mm + bit_mm * direction)};
  return {};
}

View view_of(const detail::DrawnBone& drawn, const Camera& camera, const std::optional<RenderedBit>& bit) {
  check_camera(camera);
  std::optional<DrawnSolid> drawn_bit;
  if (bit) drawn_bit.emplace(bit->bit, bit->pose, Eigen::Array3d::Zero());
  View view;
  view.camera = camera;
  const std::size_t pixels = view.pixel(0, camera.height);
  view.depth_mm.assign(pixels, 0.0F);
  view.normals.assign(3 * pixels, 0.0F);
  view.mask.assign(pixels, 0);
  const Vec3 eye_mm = camera.eye_mm();
  const bool is_in_bone = BoneRay(drawn).distance_mm(eye_mm) < 0.0;
  tbb::parallel_for(0, camera.height, [&](int row) {
    BoneRay ray(drawn);
    for (int column = 0; column < camera.width; ++column) {
      const Vec3 direction = (camera.point_mm(column, row, 1.0) - eye_mm).normalized();
      const Hit hit = first_hit(ray, drawn_bit, eye_mm, direction, is_in_bone);
      if (hit.seen == Seen::nothing) continue;
      const std::size_t pixel = view.pixel(column, row);
      view.depth_mm[pixel] = static_cast<float>(hit.way_mm * direction.dot(camera.forward()));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        view.normals[3 * pixel + axis] = static_cast<float>(hit.normal[static_cast<Eigen::Index>(axis)]);
      }
      view.mask[pixel] = static_cast<std::uint8_t>(hit.seen);
    }
  });
  return view;
}

}  // namespace

View view_bone(const BoneModel& bone, const Camera& camera, const std::optional<RenderedBit>& bit) {
  return view_of(detail::DrawnBone(bone), camera, bit);
}

View view_bone(const CutHole& bone, const Camera& camera, const std::optional<RenderedBit>& bit) {
  return view_of(detail::DrawnBone(bone.bone, bone.hole->hole), camera, bit);
}

}  // namespace spinaltap

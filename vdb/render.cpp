#include "vdb/render.h"

#include <openvdb/math/Ray.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/RayIntersector.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/drawn_solid.h"

namespace spinaltap {
namespace {

using openvdb::FloatGrid;
using Intersector = openvdb::tools::LevelSetRayIntersector<FloatGrid>;
using Sampler = openvdb::tools::GridSampler<FloatGrid::ConstAccessor, openvdb::tools::BoxSampler>;
using Colour = Eigen::Array3d;
using detail::DrawnSolid;

/// Parallel projection onto a rectangle that holds the bone seen from `from`.
struct Camera {
  Vec3 forward;
  Vec3 right;
  Vec3 up;
  Vec3 centre_mm = Vec3::Zero();
  double mm_per_pixel = 0.0;
  double reach_mm = 0.0;

  Camera(const BoneModel& shown, const RenderOptions& options)
      : forward(-options.from.normalized()), right(forward.cross(options.up).normalized()), up(right.cross(forward)) {
    constexpr double kMargin = 1.06;
    // The leaves of the narrow band lie along the whole surface.
    Box3 seen_mm;
    const FloatGrid& grid = *shown.grids().sdf;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
      const Vec3 p_mm = detail::from_vdb(grid.indexToWorld(leaf->origin().asVec3d() + openvdb::Vec3d(3.5)));
      seen_mm.extend(Vec3(p_mm.dot(right), p_mm.dot(up), p_mm.dot(forward)));
    }
    const Vec3 centre = seen_mm.center();
    centre_mm = centre.x() * right + centre.y() * up + centre.z() * forward;
    mm_per_pixel = kMargin * std::max(seen_mm.sizes().x() / options.width, seen_mm.sizes().y() / options.height);
    reach_mm = seen_mm.sizes().norm();
  }

  /// Start of the ray through a place of the picture, pixels from its upper left corner.
  Vec3 start_mm(double x, double y, const RenderOptions& options) const {
    return centre_mm + mm_per_pixel * ((x - 0.5 * options.width) * right + (0.5 * options.height - y) * up) -
           reach_mm * forward;
  }
};

/// All that a picture shows.
struct Scene {
  const BoneModel& bone;
  const RenderOptions& options;
  Camera camera;
  Intersector intersector;
  std::vector<DrawnSolid> solids;

  Scene(const BoneModel& shown, const RenderOptions& how)
      : bone(shown),
        options(how),
        camera(how.uncut != nullptr ? *how.uncut : shown, how),
        intersector(*shown.grids().sdf) {
    constexpr double kRodMm = 0.7;
    const Colour steel(0.55, 0.60, 0.68), green(0.10, 0.62, 0.28);
    if (how.bit) solids.emplace_back(how.bit->bit, how.bit->pose, steel);
    for (const DrillPath& path : how.paths) {
      check_path(path);
      const double tip_mm = std::min(kRodMm, 0.5 * path.length_mm());
      solids.emplace_back(DrillBit{kRodMm, path.length_mm(), tip_mm}, Pose{path.target_mm, path.direction()}, green);
    }
  }
};

/// One thread's view of the grids.
class Tracer {
 public:
  explicit Tracer(const Scene& scene) : Tracer(scene, scene.bone, scene.options) {}

  /// The colour at the end of a ray: what surfaces keep back of the light from behind, from the eye on.
  Colour trace(const Vec3& start_mm) {
    constexpr int kMostSurfaces = 32;
    const Vec3& forward = scene_.camera.forward;
    double solid_mm = DrawnSolid::kMissed;
    const DrawnSolid* solid = nullptr;
    for (const DrawnSolid& one : scene_.solids) {
      const double way_mm = one.way_mm(start_mm, forward);
      if (way_mm < solid_mm) {
        solid_mm = way_mm;
        solid = &one;
      }
    }
    Colour colour = Colour::Zero();
    double light = 1.0;
    double way_mm = 0.0;
    for (int surface = 0; surface < kMostSurfaces; ++surface) {
      way_mm = next_surface_mm(start_mm, way_mm);
      if (!(way_mm < solid_mm)) break;
      const Vec3 p_mm = start_mm + way_mm * forward;
      const double kept = is_new(p_mm) ? std::max(scene_.options.opacity, kNewOpacity) : scene_.options.opacity;
      if (kept > 0.0) colour += light * kept * shade(surface_colour(p_mm), normal(p_mm), p_mm);
      light *= 1.0 - kept;
      if (light < kLeastLight) return colour;
    }
    if (solid == nullptr) return colour + light * background();
    const Vec3 p_mm = start_mm + solid_mm * forward;
    return colour + light * (solid->colour() * light_on(solid->normal(p_mm))).min(1.0);
  }

 private:
  static constexpr double kNewOpacity = 0.75;
  static constexpr double kLeastLight = 1e-3;

  Tracer(const Scene& scene, const BoneModel& bone, const RenderOptions& options)
      : scene_(scene),
        intersector_(scene.intersector),
        sdf_accessor_(bone.grids().sdf->getConstAccessor()),
        sdf_(sdf_accessor_, bone.grids().sdf->transform()),
        hu_accessor_(bone.grids().hu->getConstAccessor()),
        hu_(hu_accessor_, bone.grids().hu->transform()),
        uncut_grid_(options.uncut != nullptr ? options.uncut->grids().sdf : bone.grids().sdf),
        uncut_accessor_(uncut_grid_->getConstAccessor()),
        uncut_(uncut_accessor_, uncut_grid_->transform()),
        new_depth_mm_(options.uncut != nullptr ? 1.5 * bone.voxel_mm() : 1e30),
        step_mm_(bone.voxel_mm()) {}

  static Colour background() { return {1.0, 1.0, 1.0}; }

  /// Where the ray next goes into bone or out of it, beyond `from_mm`; infinite: nowhere.
  double next_surface_mm(const Vec3& start_mm, double from_mm) {
    using Ray = openvdb::math::Ray<double>;
    const double begin_mm = from_mm > 0.0 ? from_mm + 0.02 * step_mm_ : 0.0;
    const Ray ray(detail::to_vdb(start_mm), detail::to_vdb(scene_.camera.forward), begin_mm);
    openvdb::Vec3d hit;
    if (!intersector_.intersectsWS(ray, hit)) return DrawnSolid::kMissed;
    return (detail::from_vdb(hit) - start_mm).dot(scene_.camera.forward);
  }

  bool is_new(const Vec3& p_mm) { return -static_cast<double>(uncut_.wsSample(detail::to_vdb(p_mm))) >= new_depth_mm_; }

  double distance_mm(const Vec3& p_mm) { return static_cast<double>(sdf_.wsSample(detail::to_vdb(p_mm))); }

  Vec3 normal(const Vec3& p_mm) {
    Vec3 slope;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = step_mm_ * Vec3::Unit(axis);
      slope[axis] = distance_mm(p_mm + step) - distance_mm(p_mm - step);
    }
    return slope.norm() > 0.0 ? slope.normalized() : Vec3(-scene_.camera.forward);
  }

  /// Share of a few steps outward that are free of bone: hollows come out darker.
  double openness(const Vec3& p_mm, const Vec3& n) {
    constexpr int kSteps = 4;
    double blocked = 0.0;
    for (int i = 1; i <= kSteps; ++i) {
      const double way_mm = 0.7 * i * step_mm_;
      blocked += std::max(0.0, way_mm - distance_mm(p_mm + way_mm * n)) / way_mm;
    }
    return 1.0 - 0.6 * blocked / kSteps;
  }

  /// Light of two lamps on a surface, whichever side is seen.
  double light_on(Vec3 n) const {
    const Camera& camera = scene_.camera;
    if (n.dot(camera.forward) > 0.0) n = -n;
    const Vec3 key = (-camera.forward + 0.6 * camera.up - 0.5 * camera.right).normalized();
    const Vec3 fill = (-camera.forward - 0.3 * camera.up + 0.8 * camera.right).normalized();
    return 0.28 + 0.62 * std::max(0.0, n.dot(key)) + 0.18 * std::max(0.0, n.dot(fill));
  }

  Colour shade(const Colour& surface, const Vec3& n, const Vec3& p_mm) {
    return (surface * light_on(n) * openness(p_mm, n)).min(1.0);
  }

  /// Bone on the old surface; on a new one, dark red marrow to white cortex by CT number.
  Colour surface_colour(const Vec3& p_mm) {
    constexpr double kMarrowHu = -50.0;
    constexpr double kCortexHu = 800.0;
    Colour bone(0.94, 0.89, 0.79);
    if (!is_new(p_mm)) return bone;
    const Colour marrow(0.62, 0.20, 0.16);
    const Colour cortex(1.0, 0.97, 0.90);
    const double hu = static_cast<double>(hu_.wsSample(detail::to_vdb(p_mm)));
    const double t = std::clamp((hu - kMarrowHu) / (kCortexHu - kMarrowHu), 0.0, 1.0);
    return marrow + t * (cortex - marrow);
  }

  const Scene& scene_;
  Intersector intersector_;
  FloatGrid::ConstAccessor sdf_accessor_;
  Sampler sdf_;
  FloatGrid::ConstAccessor hu_accessor_;
  Sampler hu_;
  FloatGrid::ConstPtr uncut_grid_;
  FloatGrid::ConstAccessor uncut_accessor_;
  Sampler uncut_;
  double new_depth_mm_;
  double step_mm_;
};

/// One ray through the middle of each pixel.
std::vector<Colour> pixel_centres(const Scene& scene, const Progress& progress) {
  const RenderOptions& options = scene.options;
  const auto width = static_cast<std::size_t>(options.width);
  std::vector<Colour> centres(width * static_cast<std::size_t>(options.height));
  ProgressCounter counter(progress, "drawing", static_cast<std::size_t>(options.height));
  tbb::parallel_for(0, options.height, [&](int y) {
    Tracer tracer(scene);
    for (int x = 0; x < options.width; ++x) {
      centres[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] =
          tracer.trace(scene.camera.start_mm(x + 0.5, y + 0.5, options));
    }
    counter.add();
  });
  return centres;
}

/// Whether a pixel differs so from one beside it that a single ray would show as a step.
bool is_at_edge(const std::vector<Colour>& centres, const RenderOptions& options, int x, int y) {
  constexpr double kStep = 0.03;
  const auto colour_at = [&](int i, int j) -> const Colour& {
    return centres[static_cast<std::size_t>(j) * static_cast<std::size_t>(options.width) + static_cast<std::size_t>(i)];
  };
  const Colour& here = colour_at(x, y);
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, options.height - 1); ++j) {
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, options.width - 1); ++i) {
      if ((colour_at(i, j) - here).abs().maxCoeff() > kStep) return true;
    }
  }
  return false;
}

Colour mean_of_samples(Tracer& tracer, const Scene& scene, int x, int y) {
  constexpr int kSamples = 2;  // a side: four rays
  Colour sum = Colour::Zero();
  for (int sample = 0; sample < kSamples * kSamples; ++sample) {
    const int row = sample / kSamples;
    const double dx = (0.5 + sample % kSamples) / kSamples;
    const double dy = (0.5 + row) / kSamples;
    sum += tracer.trace(scene.camera.start_mm(x + dx, y + dy, scene.options));
  }
  return sum / (kSamples * kSamples);
}

}  // namespace

Image render_bone(const BoneModel& bone, const RenderOptions& options, const Progress& progress) {
  constexpr int kLargestSide = 16384;
  if (options.width < 1 || options.height < 1 || options.width > kLargestSide || options.height > kLargestSide) {
    fail("render: expected 1 to ", kLargestSide, " pixels a side, found ", options.width, " x ", options.height);
  }
  if (!(options.from.cross(options.up).norm() > 1e-9)) fail("render: the view and its up direction are parallel");
  if (!(options.opacity >= 0.0 && options.opacity <= 1.0)) {
    fail("render: expected an opacity from 0 to 1, found ", options.opacity);
  }
  const Scene scene(bone, options);
  const std::vector<Colour> centres = pixel_centres(scene, progress);
  const auto width = static_cast<std::size_t>(options.width);
  Image image{options.width, options.height, {}};
  image.rgb.resize(3 * centres.size());
  tbb::parallel_for(0, options.height, [&](int y) {
    Tracer tracer(scene);
    for (int x = 0; x < options.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      const Colour colour = is_at_edge(centres, options, x, y) ? mean_of_samples(tracer, scene, x, y) : centres[pixel];
      for (int channel = 0; channel < 3; ++channel) {
        image.rgb[3 * pixel + static_cast<std::size_t>(channel)] =
            static_cast<std::uint8_t>(std::lround(255.0 * std::pow(colour[channel], 1.0 / 1.6)));
      }
    }
  });
  return image;
}

}  // namespace spinaltap

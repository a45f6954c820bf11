#include "vdb/picture/render.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "core/base/hu_colour.h"
#include "core/tool/path_curve.h"
#include "vdb/picture/detail/bone_ray.h"
#include "vdb/picture/detail/drawn_solid.h"

namespace spinaltap {
namespace {

using Sampler = openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::BoxSampler>;
using Colour = Eigen::Array3d;
using detail::BoneRay;
using detail::DrawnSolid;

/// Parallel projection onto a rectangle that holds the bone seen from `from`.
struct Projection {
  Vec3 forward;
  Vec3 right;
  Vec3 up;
  Vec3 centre_mm = Vec3::Zero();
  double mm_per_pixel = 0.0;
  double reach_mm = 0.0;

  Projection(const openvdb::FloatGrid& grid, const RenderOptions& options)
      : forward(-options.from.normalized()), right(forward.cross(options.up).normalized()), up(right.cross(forward)) {
    constexpr double kMargin = 1.06;
    // The leaves of the narrow band lie along the whole surface.
    Box3 seen_mm;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
      const Vec3 p_mm = detail::from_vdb(grid.indexToWorld(leaf->origin().asVec3d() + openvdb::Vec3d(3.5)));
      seen_mm.extend(Vec3(p_mm.dot(right), p_mm.dot(up), p_mm.dot(forward)));
    }
    const Vec3 centre = seen_mm.center();
    centre_mm = centre.x() * right + centre.y() * up + centre.z() * forward;
    mm_per_pixel = kMargin * std::max(seen_mm.sizes().x() / options.width, seen_mm.sizes().y() / options.height);
    reach_mm = seen_mm.sizes().norm();
    if (!options.close_up) return;
    mm_per_pixel = options.close_up->width_mm / options.width;
    // Looked at from beyond all of the bone, wherever that place is.
    reach_mm += (options.close_up->centre_mm - centre_mm).norm();
    centre_mm = options.close_up->centre_mm;
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
  detail::DrawnBone drawn;
  Projection camera;
  std::vector<DrawnSolid> solids;

  Scene(const BoneModel& shown, const RenderOptions& how)
      : bone(shown), options(how), drawn(shown), camera(*drawn.bone_grid, how) {
    constexpr double kRodMm = 0.7;
    const Colour steel(0.55, 0.60, 0.68), green(0.10, 0.62, 0.28), blue(0.10, 0.36, 0.72);
    if (how.bit) solids.emplace_back(how.bit->bit, how.bit->pose, steel);
    for (const RenderedBit& tool : how.tools) solids.emplace_back(tool.bit, tool.pose, blue);
    for (const DrillPath& path : how.paths) {
      check_path(path);
      // A curved one in short rods: 2 mm are 0.02 mm off a bend of 30 mm.
      constexpr double kStraightMm = 2.0;
      const std::vector<Vec3> places_mm = PathCurve(path).places_mm(kStraightMm);
      for (std::size_t n = 1; n < places_mm.size(); ++n) {
        const Vec3 way_mm = places_mm[n] - places_mm[n - 1];
        const double length_mm = way_mm.norm();
        const double tip_mm = n + 1 < places_mm.size() ? 1e-3 * length_mm : std::min(kRodMm, 0.5 * length_mm);
        const double blunt_mm = n + 1 < places_mm.size() ? kRodMm : 0.0;
        solids.emplace_back(DrillBit{kRodMm, length_mm, tip_mm, BitShape::drill, blunt_mm},
                            Pose{places_mm[n], way_mm.normalized()}, green);
      }
    }
  }
};

/// One thread's view of the grids.
class Tracer {
 public:
  explicit Tracer(const Scene& scene)
      : scene_(scene),
        ray_(scene.drawn, scene.options.cut),
        hu_accessor_(scene.bone.grids().hu->getConstAccessor()),
        hu_(hu_accessor_, scene.bone.grids().hu->transform()),
        step_mm_(scene.bone.voxel_mm()) {}

  /// The colour at the end of a ray: what surfaces keep back of the light from behind, from the eye on.
  Colour trace(const Vec3& start_mm) {
    constexpr int kMaxSurfaces = 32;
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
    ray_.begin(start_mm, forward, false);
    for (int n = 0; n < kMaxSurfaces; ++n) {
      const BoneRay::Surface surface = ray_.next_surface();
      if (!(surface.way_mm < solid_mm)) break;
      const Vec3 p_mm = start_mm + surface.way_mm * forward;
      const bool is_new = surface.kind != BoneRay::Kind::bone;
      const double kept = is_new ? std::max(scene_.options.opacity, kNewOpacity) : scene_.options.opacity;
      if (kept > 0.0) {
        colour += light * kept * shade(is_new ? cut_colour(p_mm) : kBone, ray_.normal(p_mm, surface.kind), p_mm);
      }
      light *= 1.0 - kept;
      if (light < kMinLight) return colour;
    }
    if (solid == nullptr) return colour + light * background();
    const Vec3 p_mm = start_mm + solid_mm * forward;
    return colour + light * (solid->colour() * light_on(solid->normal(p_mm))).min(1.0);
  }

 private:
  inline static const Colour kBone{0.94, 0.89, 0.79};
  static constexpr double kNewOpacity = 0.75;
  static constexpr double kMinLight = 1e-3;

  static Colour background() { return {1.0, 1.0, 1.0}; }

  /// Share of a few steps outward that are free of bone: hollows come out darker.
  double openness(const Vec3& p_mm, const Vec3& n) {
    constexpr int kSteps = 4;
    double blocked = 0.0;
    for (int i = 1; i <= kSteps; ++i) {
      const double way_mm = 0.7 * i * step_mm_;
      blocked += std::max(0.0, way_mm - ray_.distance_mm(p_mm + way_mm * n)) / way_mm;
    }
    return 1.0 - 0.6 * blocked / kSteps;
  }

  /// Light of two lamps on a surface, whichever side is seen.
  double light_on(Vec3 n) const {
    const Projection& camera = scene_.camera;
    if (n.dot(camera.forward) > 0.0) n = -n;
    const Vec3 key = (-camera.forward + 0.6 * camera.up - 0.5 * camera.right).normalized();
    const Vec3 fill = (-camera.forward - 0.3 * camera.up + 0.8 * camera.right).normalized();
    return 0.28 + 0.62 * std::max(0.0, n.dot(key)) + 0.18 * std::max(0.0, n.dot(fill));
  }

  Colour shade(const Colour& surface, const Vec3& n, const Vec3& p_mm) {
    return (surface * light_on(n) * openness(p_mm, n)).min(1.0);
  }

  /// Close to the bone's surface the CT holds what is outside too: there it is that of a little deeper.
  Colour cut_colour(const Vec3& p_mm) {
    const double missing_mm = 1.5 * step_mm_ + ray_.bone_mm(p_mm);
    const Vec3 deep_mm = missing_mm > 0.0 ? Vec3(p_mm - missing_mm * ray_.normal(p_mm, BoneRay::Kind::bone)) : p_mm;
    return hu_colour(static_cast<double>(hu_.wsSample(detail::to_vdb(deep_mm))));
  }

  const Scene& scene_;
  BoneRay ray_;
  openvdb::FloatGrid::ConstAccessor hu_accessor_;
  Sampler hu_;
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
  if (options.close_up && !(options.close_up->centre_mm.allFinite() && options.close_up->width_mm > 0.0)) {
    fail("render: expected a close-up of a finite place, wider than 0 mm");
  }
  if (options.cut && !(options.cut->point_mm.allFinite() && options.cut->normal.norm() > 0.0)) {
    fail("render: expected a cut through a finite point, with a normal that is not zero");
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

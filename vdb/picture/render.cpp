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
  Colour trace(const Vec3& start_mm, bool may_meet_bone) {
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
    if (may_meet_bone) ray_.begin(start_mm, forward, false);
    for (int n = 0; may_meet_bone && n < kMaxSurfaces; ++n) {
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

/// A mark for each pixel that leaves of a grid are seen in.
class SeenLeaves {
 public:
  SeenLeaves(const Projection& camera, const RenderOptions& options)
      : camera_(camera),
        options_(options),
        marks_(static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height), 0) {}

  /// `more_pixels` to all sides, too.
  void mark(const openvdb::FloatGrid& grid, const openvdb::CoordBBox& voxels, double more_pixels) {
    Box3 seen;
    for (int corner = 0; corner < 8; ++corner) {
      const openvdb::Vec3d index((corner & 1) != 0 ? voxels.max().x() : voxels.min().x(),
                                 (corner & 2) != 0 ? voxels.max().y() : voxels.min().y(),
                                 (corner & 4) != 0 ? voxels.max().z() : voxels.min().z());
      const Vec3 way_mm = detail::from_vdb(grid.indexToWorld(index)) - camera_.centre_mm;
      seen.extend(Vec3(0.5 * options_.width + way_mm.dot(camera_.right) / camera_.mm_per_pixel,
                       0.5 * options_.height - way_mm.dot(camera_.up) / camera_.mm_per_pixel, 0.0));
    }
    const auto first = [&](double low, int size) {
      return static_cast<int>(std::clamp(std::floor(low - more_pixels), 0.0, static_cast<double>(size)));
    };
    const auto last = [&](double high, int size) {
      return static_cast<int>(std::clamp(std::ceil(high + more_pixels), -1.0, size - 1.0));
    };
    for (int y = first(seen.min().y(), options_.height); y <= last(seen.max().y(), options_.height); ++y) {
      const auto row = marks_.begin() + static_cast<std::ptrdiff_t>(y) * options_.width;
      const int begin = first(seen.min().x(), options_.width);
      const int end = last(seen.max().x(), options_.width) + 1;
      if (begin < end) std::fill(row + begin, row + end, std::uint8_t{1});
    }
  }

  std::vector<std::uint8_t> marks() && { return std::move(marks_); }

 private:
  const Projection& camera_;
  const RenderOptions& options_;
  std::vector<std::uint8_t> marks_;
};

/// Which pixels are traced, and how far; all where a mask is empty.
struct TracedPixels {
  std::vector<std::uint8_t> are_shown, have_centres;  ///< a pixel that is shown needs the centres beside it
  std::vector<std::uint8_t> have_bone;                ///< rays through others pass by

  bool shows(std::size_t pixel) const { return are_shown.empty() || are_shown[pixel] != 0; }
  bool has_centre(std::size_t pixel) const { return have_centres.empty() || have_centres[pixel] != 0; }
  bool may_have_bone(std::size_t pixel) const { return have_bone.empty() || have_bone[pixel] != 0; }
};

/// Rays meet a surface in the leaves of its grid alone; one that begins at a cut may begin in the bone.
std::vector<std::uint8_t> near_bone(const Scene& scene) {
  if (scene.options.cut) return {};
  SeenLeaves seen(scene.camera, scene.options);
  const openvdb::FloatGrid& grid = *scene.drawn.bone_grid;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    openvdb::CoordBBox voxels = leaf->getNodeBoundingBox();
    voxels.expand(1);
    seen.mark(grid, voxels, 1.0);
  }
  return std::move(seen).marks();
}

/// Those with rays that pass a hole so near that it may be met or darken what is met.
void leave_out_far_from_hole(const Scene& scene, TracedPixels& traced) {
  const openvdb::FloatGrid& hole = *scene.drawn.hole_grid;
  // Openness looks 2.8 voxels off a surface, slopes 1 off, and values are mixed from one voxel further.
  constexpr int kReachVoxels = 5;
  SeenLeaves shown(scene.camera, scene.options), centres(scene.camera, scene.options);
  const auto mark = [&](openvdb::CoordBBox voxels) {
    voxels.expand(kReachVoxels);
    shown.mark(hole, voxels, 2.0);
    centres.mark(hole, voxels, 3.0);
  };
  for (auto leaf = hole.tree().cbeginLeaf(); leaf; ++leaf) mark(leaf->getNodeBoundingBox());
  auto tile = hole.tree().cbeginValueAll();
  tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (*tile != hole.background()) mark(tile.getBoundingBox());
  }
  traced.are_shown = std::move(shown).marks();
  traced.have_centres = std::move(centres).marks();
}

/// One ray through the middle of each pixel.
std::vector<Colour> pixel_centres(const Scene& scene, const TracedPixels& traced, const Progress& progress) {
  const RenderOptions& options = scene.options;
  const auto width = static_cast<std::size_t>(options.width);
  std::vector<Colour> centres(width * static_cast<std::size_t>(options.height));
  ProgressCounter counter(progress, "drawing", static_cast<std::size_t>(options.height));
  tbb::parallel_for(0, options.height, [&](int y) {
    Tracer tracer(scene);
    for (int x = 0; x < options.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      if (!traced.has_centre(pixel)) continue;
      centres[pixel] = tracer.trace(scene.camera.start_mm(x + 0.5, y + 0.5, options), traced.may_have_bone(pixel));
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

Colour mean_of_samples(Tracer& tracer, const Scene& scene, bool may_meet_bone, int x, int y) {
  constexpr int kSamples = 2;  // a side: four rays
  Colour sum = Colour::Zero();
  for (int sample = 0; sample < kSamples * kSamples; ++sample) {
    const int row = sample / kSamples;
    const double dx = (0.5 + sample % kSamples) / kSamples;
    const double dy = (0.5 + row) / kSamples;
    sum += tracer.trace(scene.camera.start_mm(x + dx, y + dy, scene.options), may_meet_bone);
  }
  return sum / (kSamples * kSamples);
}

void check_options(const RenderOptions& options) {
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
}

/// Traces pixels of a picture that has the others.
void trace_into(const Scene& scene, const TracedPixels& traced, Image& image, const Progress& progress) {
  const RenderOptions& options = scene.options;
  const std::vector<Colour> centres = pixel_centres(scene, traced, progress);
  const auto width = static_cast<std::size_t>(options.width);
  tbb::parallel_for(0, options.height, [&](int y) {
    Tracer tracer(scene);
    for (int x = 0; x < options.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      if (!traced.shows(pixel)) continue;
      const Colour colour = is_at_edge(centres, options, x, y)
                                ? mean_of_samples(tracer, scene, traced.may_have_bone(pixel), x, y)
                                : centres[pixel];
      for (int channel = 0; channel < 3; ++channel) {
        // The root of white, which most pixels are, is not worked out.
        image.rgb[3 * pixel + static_cast<std::size_t>(channel)] =
            colour[channel] == 1.0
                ? std::uint8_t{255}
                : static_cast<std::uint8_t>(std::lround(255.0 * std::pow(colour[channel], 1.0 / 1.6)));
      }
    }
  });
}

}  // namespace

Image render_bone(const BoneModel& bone, const RenderOptions& options, const Progress& progress) {
  check_options(options);
  Image image{options.width, options.height, {}};
  image.rgb.resize(std::size_t{3} * static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
  const Scene scene(bone, options);
  trace_into(scene, {{}, {}, near_bone(scene)}, image, progress);
  return image;
}

Image render_drilled(const BoneModel& drilled, const Image& before, const RenderOptions& options,
                     const Progress& progress) {
  check_options(options);
  if (before.width != options.width || before.height != options.height) {
    fail("render: expected the picture before to have ", options.width, " x ", options.height, " pixels, found ",
         before.width, " x ", before.height);
  }
  const Scene scene(drilled, options);
  const bool has_hole = scene.drawn.hole_grid != nullptr;
  // Far from all holes the distance to them must be larger than any that the bone has.
  if (has_hole && scene.drawn.hole_grid->background() < scene.drawn.bone_grid->background()) {
    return render_bone(drilled, options, progress);
  }
  Image image = before;
  if (!has_hole) return image;
  TracedPixels traced{{}, {}, near_bone(scene)};
  leave_out_far_from_hole(scene, traced);
  trace_into(scene, traced, image, progress);
  return image;
}

}  // namespace spinaltap

#include "apps/report/path_slices.h"

#include <algorithm>
#include <array>
#include <string>

#include "apps/report/slice_figure.h"

namespace spinaltap {
namespace {

/// The bone and the path with some room around.
Box3 shown_box(const DrillPath& path, Box3 box) {
  const double room_mm = box.isEmpty() ? 25.0 : 5.0;
  box.extend(path.entry_mm);
  box.extend(path.target_mm);
  return Box3(box.min() - Vec3::Constant(room_mm), box.max() + Vec3::Constant(room_mm));
}

}  // namespace

std::vector<ReportDrawing> path_slices(const CtVolume& ct, const DrillPath& path, const Box3& bone_bounds_mm) {
  constexpr double kMostPixels = 1200.0;  // along the box's longest side: coarser pixels beyond 240 mm
  struct View {
    SliceFrame frame;
    std::string caption;
  };
  const Box3 box = shown_box(path, bone_bounds_mm);
  const double pixel_mm = std::max(0.2, box.sizes().maxCoeff() / kMostPixels);
  const Vec3 middle_mm = 0.5 * (path.entry_mm + path.target_mm);
  const auto standard = [&](Plane plane) {
    const SliceFrame frame = plane_frame(plane, middle_mm, box, pixel_mm);
    return View{frame, plane_caption(plane, frame)};
  };
  const SliceFrame along = path_frame(path, box, pixel_mm);
  std::array<View, 4> views{View{along, path_caption(along)}, standard(Plane::kAxial), standard(Plane::kSagittal),
                            standard(Plane::kCoronal)};
  int width = 0;
  for (const View& view : views) width = std::max(width, view.frame.width);
  std::vector<ReportDrawing> drawings;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const SliceFrame frame = grown_to(views[i].frame, width, views[i ^ 1U].frame.height);
    drawings.push_back({slice_svg(ct_slice(ct, frame), path, views[i].caption), views[i].caption});
  }
  return drawings;
}

}  // namespace spinaltap

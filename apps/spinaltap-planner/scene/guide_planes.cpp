#include "apps/spinaltap-planner/scene/guide_planes.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPlaneSource.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkTexture.h>

#include <algorithm>
#include <cstdint>
#include <optional>

#include "apps/spinaltap-planner/colours.h"

namespace spinaltap {
namespace {

constexpr double kGuideMarginMm = 6.0;  ///< around the bone
constexpr double kGuidePixelMm = 0.4;
/// Air, and what the CT does not hold, would hide the scene behind it.
constexpr HuWindow kTissue{1.0, -300.0};

/// The slice's place through the crosshair, as far as the bone reaches; nothing where it passes the bone by.
std::optional<SliceFrame> guide_frame(Plane plane, const OpenedBone& bone, const Vec3& crosshair_mm) {
  Box3 crop = bone.model().bounds_mm();
  crop.min().array() -= kGuideMarginMm;
  crop.max().array() += kGuideMarginMm;
  constexpr std::array<int, 3> kAcross{2, 1, 0};  // the axis that the plane stands on, as Plane counts
  const int across = kAcross[static_cast<std::size_t>(plane)];
  if (crosshair_mm[across] < crop.min()[across] || crosshair_mm[across] > crop.max()[across]) return std::nullopt;
  return plane_frame(plane, crosshair_mm, crop, kGuidePixelMm);
}

}  // namespace

struct GuidePlanes::Guide {
  vtkNew<vtkPlaneSource> quad;
  vtkNew<vtkTexture> texture;
  vtkNew<vtkActor> slice;
  vtkNew<vtkPoints> corners;
  vtkNew<vtkActor> frame;
  /// What the texture shows.
  std::shared_ptr<const OpenedBone> bone;
  Vec3 crosshair_mm = Vec3::Zero();
  HuWindow window;

  Guide(vtkRenderer& renderer, const QColor& colour) {
    vtkNew<vtkPolyDataMapper> slice_mapper;
    slice_mapper->SetInputConnection(quad->GetOutputPort());
    slice->SetMapper(slice_mapper);
    slice->SetTexture(texture);
    slice->GetProperty()->LightingOff();
    slice->ForceOpaqueOn();  // what there is of it
    texture->InterpolateOn();
    texture->EdgeClampOn();
    corners->SetNumberOfPoints(4);
    vtkNew<vtkCellArray> lines;
    lines->InsertNextCell({0, 1, 2, 3, 0});
    vtkNew<vtkPolyData> outline;
    outline->SetPoints(corners);
    outline->SetLines(lines);
    vtkNew<vtkPolyDataMapper> frame_mapper;
    frame_mapper->SetInputData(outline);
    frame->SetMapper(frame_mapper);
    frame->GetProperty()->LightingOff();
    frame->GetProperty()->SetColor(colour.redF(), colour.greenF(), colour.blueF());
    for (vtkActor* actor : {slice.Get(), frame.Get()}) {
      actor->VisibilityOff();
      renderer.AddActor(actor);
    }
  }

  /// `tissue`: black where the slice is left out.
  void show(const CtSlice& cut, const CtSlice& tissue) {
    const SliceFrame& place = cut.frame;
    // The picture's edge lies half a pixel outside of its outermost pixels' centres.
    const auto corner = [&](double column, double row) { return place.to_patient({column - 0.5, row - 0.5, 0.0}); };
    std::array<Vec3, 4> around{corner(0, place.height), corner(place.width, place.height), corner(place.width, 0),
                               corner(0, 0)};
    quad->SetOrigin(around[0].data());
    quad->SetPoint1(around[1].data());
    quad->SetPoint2(around[3].data());
    for (vtkIdType n = 0; n < 4; ++n) corners->SetPoint(n, around[static_cast<std::size_t>(n)].data());
    corners->Modified();
    vtkNew<vtkImageData> image;
    image->SetDimensions(place.width, place.height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 2);
    const std::uint8_t* grey = cut.image.rgb.data();
    const std::uint8_t* is_there = tissue.image.rgb.data();
    for (int row = 0; row < place.height; ++row) {
      // VTK counts rows from below.
      auto* out = static_cast<std::uint8_t*>(image->GetScalarPointer(0, place.height - 1 - row, 0));
      for (int column = 0; column < place.width; ++column, grey += 3, is_there += 3) {
        *out++ = *grey;
        *out++ = *is_there;
      }
    }
    texture->SetInputData(image);
  }
};

GuidePlanes::GuidePlanes(vtkRenderer& renderer) {
  for (std::size_t n = 0; n < guides_.size(); ++n) {
    guides_[n] = std::make_unique<Guide>(renderer, plane_colour(static_cast<Plane>(n)));
  }
}

GuidePlanes::~GuidePlanes() = default;

void GuidePlanes::prepare(const std::shared_ptr<const OpenedBone>& bone, const ViewState& state, double pixel_ratio) {
  for (std::size_t n = 0; n < guides_.size(); ++n) {
    const auto plane = static_cast<Plane>(n);
    Guide& guide = *guides_[n];
    std::optional<SliceFrame> place;
    if (bone != nullptr && state.shows_guide(plane)) place = guide_frame(plane, *bone, state.crosshair_mm());
    guide.slice->SetVisibility(place.has_value());
    guide.frame->SetVisibility(place.has_value());
    guide.frame->GetProperty()->SetLineWidth(static_cast<float>(2.5 * pixel_ratio));
    if (!place) continue;
    const HuWindow& window = state.window();
    const bool is_same = guide.bone == bone && guide.crosshair_mm == state.crosshair_mm() &&
                         guide.window.width_hu == window.width_hu && guide.window.level_hu == window.level_hu;
    if (is_same) continue;
    guide.bone = bone;
    guide.crosshair_mm = state.crosshair_mm();
    guide.window = window;
    guide.show(ct_slice(bone->ct, *place, window), ct_slice(bone->ct, *place, kTissue));
  }
}

}  // namespace spinaltap

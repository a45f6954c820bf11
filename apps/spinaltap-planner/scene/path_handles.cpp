#include "apps/spinaltap-planner/scene/path_handles.h"

#include <vtkActor.h>
#include <vtkNew.h>
#include <vtkPlatonicSolidSource.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>

#include "apps/spinaltap-planner/colours.h"
#include "apps/spinaltap-planner/scene/surface_look.h"

namespace spinaltap {

struct PathHandles::Shape {
  vtkNew<vtkActor> body;
  vtkNew<vtkActor> outline;  ///< a little larger, its inside only: a rim around the body
  vtkRenderer& front;

  Shape(vtkRenderer& front_layer, PathEnd end) : front(front_layer) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->ScalarVisibilityOff();
    if (end == PathEnd::entry) {
      vtkNew<vtkSphereSource> ball;
      ball->SetRadius(1.0);
      ball->SetThetaResolution(24);
      ball->SetPhiResolution(16);
      mapper->SetInputConnection(ball->GetOutputPort());
    } else {
      vtkNew<vtkPlatonicSolidSource> octahedron;
      octahedron->SetSolidTypeToOctahedron();
      mapper->SetInputConnection(octahedron->GetOutputPort());
      body->GetProperty()->SetInterpolationToFlat();
    }
    body->SetMapper(mapper);
    outline->SetMapper(mapper);
    light_softly(*body);
    outline->GetProperty()->LightingOff();
    outline->GetProperty()->FrontfaceCullingOn();
    front.AddActor(body);
    front.AddActor(outline);
  }
  ~Shape() {
    front.RemoveActor(body);
    front.RemoveActor(outline);
  }
  Shape(const Shape&) = delete;
  Shape& operator=(const Shape&) = delete;

  void show(const Vec3& p_mm, double radius_mm, double rim_mm, const QColor& colour, bool is_hot) {
    body->SetPosition(Vec3(p_mm).data());
    body->SetScale(radius_mm);
    outline->SetPosition(Vec3(p_mm).data());
    outline->SetScale(radius_mm + rim_mm);
    body->GetProperty()->SetColor(colour.redF(), colour.greenF(), colour.blueF());
    const double rim = is_hot ? 1.0 : 0.08;
    outline->GetProperty()->SetColor(rim, rim, rim);
  }
};

PathHandles::PathHandles(vtkRenderer& front) : front_(front) {}

PathHandles::~PathHandles() = default;

void PathHandles::prepare(const std::vector<DrillPath>& paths, int chosen, const std::optional<PathHandle>& hot,
                          const SceneCamera& camera) {
  constexpr double kHotShare = 1.35;
  constexpr double kOtherShare = 0.7;  // of paths that are not chosen
  constexpr double kRimPixels = 1.5;
  while (shapes_.size() > 2 * paths.size()) shapes_.pop_back();
  while (shapes_.size() < 2 * paths.size()) {
    shapes_.push_back(std::make_unique<Shape>(front_, shapes_.size() % 2 == 0 ? PathEnd::entry : PathEnd::target));
  }
  for (std::size_t n = 0; n < paths.size(); ++n) {
    for (const PathEnd end : {PathEnd::entry, PathEnd::target}) {
      const Vec3 p_mm = place_of(paths[n], end);
      const double pixel_mm = camera.mm_per_pixel(camera.depth_mm(p_mm));
      const bool is_hot = hot == PathHandle{static_cast<int>(n), end};
      const double share = is_hot ? kHotShare : static_cast<int>(n) == chosen ? 1.0 : kOtherShare;
      // An octahedron looks smaller than a ball around it.
      const double radius_px = share * kHandlePixels * (end == PathEnd::target ? 1.35 : 1.0);
      shapes_[2 * n + (end == PathEnd::entry ? 0 : 1)]->show(p_mm, radius_px * pixel_mm, kRimPixels * pixel_mm,
                                                             path_colour(n), is_hot);
    }
  }
}

}  // namespace spinaltap

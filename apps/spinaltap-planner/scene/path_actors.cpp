#include "apps/spinaltap-planner/scene/path_actors.h"

#include <vtkActor.h>
#include <vtkLineSource.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <optional>

#include "apps/spinaltap-planner/colours.h"
#include "apps/spinaltap-planner/scene/tool_actor.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

constexpr double kAxisBeyondMm = 14.0;  ///< before the entry, so that it is seen where the operator comes from
constexpr double kScrewOpacity = 0.35;

QColor faint_colour(const QColor& colour) {
  const QColor dull(120, 124, 130);
  const auto between = [](int a, int b) { return (2 * a + 3 * b) / 5; };
  return {between(colour.red(), dull.red()), between(colour.green(), dull.green()),
          between(colour.blue(), dull.blue())};
}

}  // namespace

struct PathActors::PathShape {
  ToolActor bit;
  ToolActor screw;
  ToolActor head;
  vtkNew<vtkLineSource> line;
  vtkNew<vtkActor> axis;
  vtkNew<vtkActor> axis_in_bone;
  vtkNew<vtkTextActor> name;
  Vec3 name_mm = Vec3::Zero();
  vtkRenderer& scene;
  vtkRenderer& front;

  PathShape(vtkRenderer& scene_layer, vtkRenderer& front_layer) : scene(scene_layer), front(front_layer) {
    vtkNew<vtkPolyDataMapper> line_mapper;
    line_mapper->SetInputConnection(line->GetOutputPort());
    for (vtkActor* actor : {axis.Get(), axis_in_bone.Get()}) {
      actor->SetMapper(line_mapper);
      actor->GetProperty()->LightingOff();
    }
    // Blended at once: these lines lie behind nothing that would need sorting.
    axis_in_bone->ForceOpaqueOn();
    for (ToolActor* part : {&screw, &head}) part->actor()->GetProperty()->SetOpacity(kScrewOpacity);
    vtkTextProperty* text = name->GetTextProperty();
    text->SetFontFamilyToArial();
    text->SetJustificationToCentered();
    text->SetVerticalJustificationToCentered();
    text->SetBackgroundColor(0.10, 0.12, 0.15);
    scene.AddActor(bit.actor());
    scene.AddActor(screw.actor());
    scene.AddActor(head.actor());
    scene.AddActor(axis);
    front.AddActor(axis_in_bone);
    front.AddActor(name);
  }
  ~PathShape() {
    scene.RemoveActor(bit.actor());
    scene.RemoveActor(screw.actor());
    scene.RemoveActor(head.actor());
    scene.RemoveActor(axis);
    front.RemoveActor(axis_in_bone);
    front.RemoveActor(name);
  }
  PathShape(const PathShape&) = delete;
  PathShape& operator=(const PathShape&) = delete;

  void show(const DrillPath& path, const QColor& own_colour, bool is_chosen) {
    const QColor colour = is_chosen ? own_colour : faint_colour(own_colour);
    const PathCurve curve(path);
    const Pose pose{path.target_mm, curve.direction_at(curve.length_mm())};
    bit.show(path.bit, pose);
    bit.set_colour(colour);
    screw.actor()->SetVisibility(path.screw.has_value());
    if (path.screw) {
      screw.show(path.screw->outline(), pose);
      screw.set_colour(colour);
    }
    const std::optional<BodyBehind> behind = head_of(path);
    head.actor()->SetVisibility(behind.has_value());
    if (behind) {
      head.show(behind->outline, behind->pose);
      head.set_colour(colour);
    }
    const double tool_mm = std::max(path.bit.length_mm, path.screw ? path.screw->length_mm : 0.0);
    const double back_mm = std::max(path.length_mm(), tool_mm) + kAxisBeyondMm;
    name_mm = path.target_mm - back_mm * pose.axis;
    std::vector<Vec3> places_mm{name_mm, path.target_mm};
    if (path.is_curved()) {
      name_mm = curve.at_mm(-kAxisBeyondMm);
      places_mm = curve.places_mm(0.5);
      places_mm.insert(places_mm.begin(), name_mm);
    }
    vtkNew<vtkPoints> points;
    for (const Vec3& p_mm : places_mm) points->InsertNextPoint(p_mm.data());
    line->SetPoints(points);
    for (vtkActor* actor : {axis.Get(), axis_in_bone.Get()}) {
      actor->GetProperty()->SetColor(colour.redF(), colour.greenF(), colour.blueF());
    }
    axis_in_bone->GetProperty()->SetOpacity(is_chosen ? 0.6 : 0.35);
    name->SetInput((" " + path.name + " ").c_str());  // VTK cuts the last letter short
    name->SetVisibility(!path.name.empty());
    const QColor letters = is_chosen ? own_colour.lighter(115) : faint_colour(own_colour).lighter(125);
    name->GetTextProperty()->SetColor(letters.redF(), letters.greenF(), letters.blueF());
    name->GetTextProperty()->SetBackgroundOpacity(is_chosen ? 0.75 : 0.5);
    name->GetTextProperty()->SetBold(is_chosen);
  }

  void hide_tools() {
    bit.actor()->VisibilityOff();
    screw.actor()->VisibilityOff();
    head.actor()->VisibilityOff();
  }

  void prepare(const SceneCamera& camera, double height_px, double pixel_ratio) {
    constexpr double kNamePixels = 14.0;
    const bool is_before_eye = camera.depth_mm(name_mm) > 0.0;
    const Eigen::Vector2d pixel = is_before_eye ? camera.to_pixel(name_mm) : Eigen::Vector2d(-1e4, -1e4);
    name->SetDisplayPosition(static_cast<int>(pixel_ratio * pixel.x()),
                             static_cast<int>(pixel_ratio * (height_px - pixel.y() + kNamePixels)));
    name->GetTextProperty()->SetFontSize(static_cast<int>(kNamePixels));
    axis->GetProperty()->SetLineWidth(static_cast<float>(1.5 * pixel_ratio));
    axis_in_bone->GetProperty()->SetLineWidth(static_cast<float>(1.5 * pixel_ratio));
  }
};

PathActors::PathActors(vtkRenderer& scene, vtkRenderer& front)
    : scene_(scene), front_(front), drilling_(std::make_unique<ToolActor>()) {
  const QColor steel(176, 186, 200);
  drilling_->set_colour(steel);
  scene_.AddActor(drilling_->actor());
}

PathActors::~PathActors() { scene_.RemoveActor(drilling_->actor()); }

void PathActors::set_paths(const std::vector<DrillPath>& paths, int chosen,
                           const std::optional<std::pair<DrillBit, Pose>>& bit, bool shows_tools) {
  while (shapes_.size() > paths.size()) shapes_.pop_back();
  while (shapes_.size() < paths.size()) shapes_.push_back(std::make_unique<PathShape>(scene_, front_));
  for (std::size_t n = 0; n < paths.size(); ++n) {
    const bool is_chosen = static_cast<int>(n) == chosen;
    shapes_[n]->show(paths[n], path_colour(n), is_chosen);
    if (!shows_tools || (is_chosen && bit)) shapes_[n]->hide_tools();
  }
  if (bit) drilling_->show(bit->first, bit->second);
  drilling_->actor()->SetVisibility(shows_tools && bit.has_value());
}

void PathActors::prepare(const SceneCamera& camera, double height_px, double pixel_ratio) {
  for (const auto& shape : shapes_) shape->prepare(camera, height_px, pixel_ratio);
}

}  // namespace spinaltap

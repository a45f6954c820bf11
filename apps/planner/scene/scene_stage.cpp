#include "apps/planner/scene/scene_stage.h"

#include <QVTKOpenGLNativeWidget.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkLight.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "apps/planner/scene/orientation_marker.h"

namespace spinaltap {
namespace {

void observe(vtkObject& object, unsigned long event, const std::function<void()>& action) {
  vtkNew<vtkCallbackCommand> command;
  command->SetClientData(new std::function<void()>(action));
  command->SetClientDataDeleteCallback([](void* data) { delete static_cast<std::function<void()>*>(data); });
  command->SetCallback(
      [](vtkObject*, unsigned long, void* data, void*) { (*static_cast<std::function<void()>*>(data))(); });
  object.AddObserver(event, command);
}

}  // namespace

SceneStage::SceneStage(QVTKOpenGLNativeWidget& pane, std::function<void()> prepare) : pane_(pane) {
  window_->SetMultiSamples(0);
  window_->SetNumberOfLayers(2);
  scene_->SetGradientBackground(true);
  scene_->SetBackground(0.115, 0.135, 0.165);   // below
  scene_->SetBackground2(0.235, 0.270, 0.315);  // above
  front_->SetLayer(1);
  front_->SetActiveCamera(scene_->GetActiveCamera());
  front_->InteractiveOff();
  for (vtkRenderer* layer : {scene_.Get(), front_.Get()}) {
    layer->AutomaticLightCreationOff();
    // Where there is no light, VTK gives shaders no normals.
    vtkNew<vtkLight> lamp;
    lamp->SetLightTypeToHeadlight();
    layer->AddLight(lamp);
    window_->AddRenderer(layer);
  }
  marker_ = std::make_unique<OrientationMarker>(*window_);
  scene_->GetActiveCamera()->SetViewAngle(SceneCamera::kViewAngle / kDegree);
  observe(*window_, vtkCommand::StartEvent, [this, prepare = std::move(prepare)] {
    frame_began_ = std::chrono::steady_clock::now();
    prepare();
  });
  observe(*window_, vtkCommand::EndEvent, [this] {
    // Only then has a processor, or a graphics card, really drawn it.
    window_->WaitForCompletion();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - frame_began_;
    last_frame_ms_ = took.count();
    ++frames_;
  });
  pane_.setRenderWindow(window_);
}

SceneStage::~SceneStage() { pane_.setRenderWindow(static_cast<vtkGenericOpenGLRenderWindow*>(nullptr)); }

void SceneStage::look(const SceneCamera& camera, double reach_mm) {
  vtkCamera& eye = *scene_->GetActiveCamera();
  eye.SetPosition(Vec3(camera.eye_mm()).data());
  eye.SetFocalPoint(Vec3(camera.focus_mm()).data());
  eye.SetViewUp(Vec3(camera.up()).data());
  // Near what is looked at from inside the scene, without giving away the depth buffer's precision.
  const double far_mm = camera.distance_mm() + reach_mm;
  eye.SetClippingRange(std::max(camera.distance_mm() - reach_mm, 2e-3 * far_mm), far_mm);
  marker_->look(camera, pane_.width(), pane_.height());
}

void SceneStage::render(bool is_smooth) {
  scene_->SetUseFXAA(is_smooth);
  window_->Render();
}

}  // namespace spinaltap

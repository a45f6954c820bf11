#include "apps/planner/scene/scene_stage.h"

#include <vtkCamera.h>
#include <vtkLight.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "apps/planner/scene/orientation_marker.h"

namespace spinaltap {

SceneStage::SceneStage() {
  window_->SetOffScreenRendering(1);
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
}

SceneStage::~SceneStage() {
  if (is_drawing()) finish();
}

void SceneStage::look(const SceneCamera& camera, double reach_mm, const QSize& size_px) {
  vtkCamera& eye = *scene_->GetActiveCamera();
  eye.SetPosition(Vec3(camera.eye_mm()).data());
  eye.SetFocalPoint(Vec3(camera.focus_mm()).data());
  eye.SetViewUp(Vec3(camera.up()).data());
  // Near what is looked at from inside the scene, without giving away the depth buffer's precision.
  const double far_mm = camera.distance_mm() + reach_mm;
  eye.SetClippingRange(std::max(camera.distance_mm() - reach_mm, 2e-3 * far_mm), far_mm);
  marker_->look(camera, size_px.width(), size_px.height());
}

void SceneStage::begin(const QSize& device_px, bool is_smooth, std::function<void()> on_done) {
  scene_->SetUseFXAA(is_smooth);
  // Actors that were removed made it current here.
  if (window_->IsCurrent()) window_->ReleaseCurrent();
  frame_ = std::async(std::launch::async, [this, device_px, on_done = std::move(on_done)] {
    Frame frame = draw(device_px);
    on_done();
    return frame;
  });
}

QImage SceneStage::finish() {
  Frame frame = frame_.get();
  last_frame_ms_ = frame.ms;
  ++frames_;
  return std::move(frame.picture);
}

SceneStage::Frame SceneStage::draw(const QSize& device_px) {
  const auto began = std::chrono::steady_clock::now();
  window_->SetSize(device_px.width(), device_px.height());
  window_->Render();
  vtkNew<vtkUnsignedCharArray> pixels;
  window_->GetRGBACharPixelData(0, 0, device_px.width() - 1, device_px.height() - 1, 0, pixels);
  window_->ReleaseCurrent();
  // VTK counts rows from below.
  QImage picture = QImage(pixels->GetPointer(0), device_px.width(), device_px.height(), 4 * device_px.width(),
                          QImage::Format_RGBX8888)
                       .mirrored()
                       .convertToFormat(QImage::Format_RGB32);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - began;
  return {std::move(picture), took.count()};
}

}  // namespace spinaltap

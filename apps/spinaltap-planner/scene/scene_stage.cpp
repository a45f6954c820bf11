#include "apps/spinaltap-planner/scene/scene_stage.h"

#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkLight.h>
#include <vtkOpenGLFramebufferObject.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <utility>

#include "apps/spinaltap-planner/scene/orientation_marker.h"

namespace spinaltap {
namespace {

// OpenGL's: VTK 9.4 has its header under another name than those before.
constexpr unsigned kColourAndDepth = 0x4000 | 0x100;  ///< GL_COLOR_BUFFER_BIT, GL_DEPTH_BUFFER_BIT
constexpr unsigned kNearest = 0x2600;                 ///< GL_NEAREST

void copy(vtkOpenGLRenderWindow& window, vtkOpenGLFramebufferObject& from, vtkOpenGLFramebufferObject& to) {
  const int* size = window.GetSize();
  const std::array<int, 4> all{0, size[0], 0, size[1]};
  vtkOpenGLState& state = *window.GetState();
  state.PushFramebufferBindings();
  from.Bind(vtkOpenGLFramebufferObject::GetReadMode());
  from.ActivateReadBuffer(0);
  to.Bind(vtkOpenGLFramebufferObject::GetDrawMode());
  to.ActivateDrawBuffer(0);
  vtkOpenGLFramebufferObject::Blit(all.data(), all.data(), kColourAndDepth, kNearest);
  state.PopFramebufferBindings();
}

void observe(vtkObject& object, unsigned long event, const std::function<void()>& action) {
  vtkNew<vtkCallbackCommand> command;
  command->SetClientData(new std::function<void()>(action));
  command->SetClientDataDeleteCallback([](void* data) { delete static_cast<std::function<void()>*>(data); });
  command->SetCallback(
      [](vtkObject*, unsigned long, void* data, void*) { (*static_cast<std::function<void()>*>(data))(); });
  object.AddObserver(event, command);
}

/// VTK counts them from below.
QImage with_rows_from_above(const QImage& image) {
#if QT_VERSION >= QT_VERSION_CHECK(6, 9, 0)
  return image.flipped(Qt::Vertical);
#else
  return image.mirrored();
#endif
}

vtkOpenGLRenderWindow& opengl(vtkRenderWindow& window) { return dynamic_cast<vtkOpenGLRenderWindow&>(window); }

}  // namespace

KeptLayer::KeptLayer() = default;

KeptLayer::~KeptLayer() = default;

void KeptLayer::keep(vtkOpenGLRenderWindow& window) {
  const int* size = window.GetSize();
  vtkOpenGLState& state = *window.GetState();
  state.PushFramebufferBindings();
  kept_->SetContext(&window);
  if (kept_->GetFBOIndex() == 0) {
    // As VTK makes the one that it draws into: only like is copied to like.
    kept_->PopulateFramebuffer(size[0], size[1], true, 1, VTK_UNSIGNED_CHAR, true, 32, 0,
                               window.GetStencilCapable() != 0);
  } else {
    kept_->Resize(size[0], size[1]);
  }
  state.PopFramebufferBindings();
  copy(window, *window.GetRenderFramebuffer(), *kept_);
}

void KeptLayer::put_back(vtkOpenGLRenderWindow& window) { copy(window, *kept_, *window.GetRenderFramebuffer()); }

void KeptLayer::release(vtkOpenGLRenderWindow& window) { kept_->ReleaseGraphicsResources(&window); }

SceneStage::SceneStage() {
  window_->SetOffScreenRendering(1);
  window_->SetMultiSamples(0);
  window_->SetNumberOfLayers(3);
  front_->SetLayer(2);
  set_layers();
  for (vtkRenderer* layer : {bone_.Get(), scene_.Get(), front_.Get()}) {
    layer->SetActiveCamera(eye_);
    layer->SetGradientBackground(true);
    layer->SetBackground(0.115, 0.135, 0.165);   // below
    layer->SetBackground2(0.235, 0.270, 0.315);  // above
    layer->AutomaticLightCreationOff();
    // Where there is no light, VTK gives shaders no normals.
    vtkNew<vtkLight> lamp;
    lamp->SetLightTypeToHeadlight();
    layer->AddLight(lamp);
    window_->AddRenderer(layer);
  }
  marker_ = std::make_unique<OrientationMarker>(*window_);
  eye_->SetViewAngle(SceneCamera::kViewAngle / kDegree);
  observe(*bone_, vtkCommand::EndEvent, [this] {
    if (!is_glass_) kept_bone_.keep(opengl(*window_));
  });
  observe(*scene_, vtkCommand::StartEvent, [this] {
    if (bone_->GetDraw() == 0) kept_bone_.put_back(opengl(*window_));
  });
}

SceneStage::~SceneStage() {
  if (is_drawing()) finish();
  kept_bone_.release(opengl(*window_));
}

/// The farther layer has the background, the nearer one keeps its depths and ends with smooth edges. Glass must be
/// drawn over what shines through it.
void SceneStage::set_layers() {
  vtkRenderer& far = is_glass_ ? *scene_ : *bone_;
  vtkRenderer& near = is_glass_ ? *bone_ : *scene_;
  far.SetLayer(0);
  far.PreserveDepthBufferOff();
  far.SetUseFXAA(false);
  near.SetLayer(1);
  near.PreserveDepthBufferOn();
}

void SceneStage::change_bone(bool is_glass) {
  is_bone_kept_ = false;
  is_glass_ = is_glass;
  set_layers();
}

void SceneStage::look(const SceneCamera& camera, double reach_mm, const QSize& size_px) {
  const vtkMTimeType before = eye_->GetMTime();
  eye_->SetPosition(Vec3(camera.eye_mm()).data());
  eye_->SetFocalPoint(Vec3(camera.focus_mm()).data());
  eye_->SetViewUp(Vec3(camera.up()).data());
  // Near what is looked at from inside the scene, without giving away the depth buffer's precision.
  const double far_mm = camera.distance_mm() + reach_mm;
  eye_->SetClippingRange(std::max(camera.distance_mm() - reach_mm, 2e-3 * far_mm), far_mm);
  if (eye_->GetMTime() != before) is_bone_kept_ = false;
  marker_->look(camera, size_px.width(), size_px.height());
}

void SceneStage::begin(const QSize& device_px, bool is_smooth, std::function<void()> on_done) {
  (is_glass_ ? *bone_ : *scene_).SetUseFXAA(is_smooth);
  if (device_px != size_px_) is_bone_kept_ = false;
  size_px_ = device_px;
  bone_->SetDraw(!is_bone_kept_);
  is_bone_kept_ = !is_glass_;
  // Actors that were removed made it current here.
  if (window_->IsCurrent()) window_->ReleaseCurrent();
  frame_ = std::async(std::launch::async, [this, device_px, on_done = std::move(on_done)] {
    QImage picture = draw(device_px);
    on_done();
    return picture;
  });
}

QImage SceneStage::finish() {
  QImage picture = frame_.get();
  ++frames_;
  return picture;
}

QImage SceneStage::draw(const QSize& device_px) {
  window_->SetSize(device_px.width(), device_px.height());
  window_->Render();
  vtkNew<vtkUnsignedCharArray> pixels;
  window_->GetRGBACharPixelData(0, 0, device_px.width() - 1, device_px.height() - 1, 0, pixels);
  window_->ReleaseCurrent();
  return with_rows_from_above(QImage(pixels->GetPointer(0), device_px.width(), device_px.height(),
                                     4 * device_px.width(), QImage::Format_RGBX8888))
      .convertToFormat(QImage::Format_RGB32);
}

}  // namespace spinaltap

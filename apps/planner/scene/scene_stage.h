#pragma once

#include <vtkNew.h>

#include <chrono>
#include <functional>
#include <memory>

#include "apps/planner/scene/scene_camera.h"

class QVTKOpenGLNativeWidget;
class vtkGenericOpenGLRenderWindow;
class vtkRenderer;

namespace spinaltap {

class OrientationMarker;

/// What frames are drawn on: a layer for the scene, one before it that shows through everything, and the marker in the
/// corner.
class SceneStage {
 public:
  /// `prepare` brings everything up to date; called at the start of each frame, whoever asked for it.
  SceneStage(QVTKOpenGLNativeWidget& pane, std::function<void()> prepare);
  ~SceneStage();
  SceneStage(const SceneStage&) = delete;
  SceneStage& operator=(const SceneStage&) = delete;

  vtkRenderer& scene() { return *scene_; }
  vtkRenderer& front() { return *front_; }
  /// `reach_mm`: how far from the focus there is anything.
  void look(const SceneCamera& camera, double reach_mm);
  /// Draws a frame now, nothing where the pane was never shown. `is_smooth`: edges without steps, which takes a third
  /// longer on a processor.
  void render(bool is_smooth);
  double last_frame_ms() const { return last_frame_ms_; }
  int frames() const { return frames_; }

 private:
  QVTKOpenGLNativeWidget& pane_;
  vtkNew<vtkGenericOpenGLRenderWindow> window_;
  vtkNew<vtkRenderer> scene_;
  vtkNew<vtkRenderer> front_;
  std::unique_ptr<OrientationMarker> marker_;
  std::chrono::steady_clock::time_point frame_began_;
  double last_frame_ms_ = 0.0;
  int frames_ = 0;
};

}  // namespace spinaltap

#pragma once

#include <vtkNew.h>

#include "apps/spinaltap-planner/scene/scene_camera.h"
#include "apps/spinaltap-planner/scene/vtk_names.h"

namespace spinaltap {

/// The cube in the corner whose sides say where the patient's left, right, front (A), back (P), head (S) and feet (I)
/// are.
class OrientationMarker {
 public:
  explicit OrientationMarker(vtkRenderWindow& window);
  ~OrientationMarker();
  OrientationMarker(const OrientationMarker&) = delete;
  OrientationMarker& operator=(const OrientationMarker&) = delete;

  /// Turns with the camera and keeps its size in a pane of so many pixels.
  void look(const SceneCamera& camera, double width_px, double height_px);

 private:
  vtkNew<vtkRenderer> corner_;
};

}  // namespace spinaltap

#include "apps/spinaltap-planner/scene/orientation_marker.h"

#include <vtkAnnotatedCubeActor.h>
#include <vtkCamera.h>
#include <vtkLight.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <algorithm>

namespace spinaltap {

OrientationMarker::OrientationMarker(vtkRenderWindow& window) {
  vtkNew<vtkAnnotatedCubeActor> cube;
  cube->SetXPlusFaceText("L");
  cube->SetXMinusFaceText("R");
  cube->SetYPlusFaceText("P");
  cube->SetYMinusFaceText("A");
  cube->SetZPlusFaceText("S");
  cube->SetZMinusFaceText("I");
  cube->SetZFaceTextRotation(90.0);
  cube->SetFaceTextScale(0.62);
  cube->GetCubeProperty()->SetColor(0.80, 0.82, 0.84);
  cube->GetCubeProperty()->SetAmbient(0.5);  // sides seen askew are legible too
  cube->GetCubeProperty()->SetDiffuse(0.5);
  cube->SetTextEdgesVisibility(0);
  for (vtkProperty* face :
       {cube->GetXPlusFaceProperty(), cube->GetXMinusFaceProperty(), cube->GetYPlusFaceProperty(),
        cube->GetYMinusFaceProperty(), cube->GetZPlusFaceProperty(), cube->GetZMinusFaceProperty()}) {
    face->SetColor(0.10, 0.13, 0.18);
    face->LightingOff();
  }
  corner_->SetLayer(1);
  corner_->InteractiveOff();
  corner_->AddActor(cube);
  corner_->AutomaticLightCreationOff();
  vtkNew<vtkLight> lamp;
  lamp->SetLightTypeToHeadlight();
  corner_->AddLight(lamp);
  corner_->GetActiveCamera()->ParallelProjectionOn();
  window.AddRenderer(corner_);
}

OrientationMarker::~OrientationMarker() = default;

void OrientationMarker::look(const SceneCamera& camera, double width_px, double height_px) {
  constexpr double kSidePixels = 84.0;
  const double width = std::min(1.0, kSidePixels / std::max(1.0, width_px));
  const double height = std::min(1.0, kSidePixels / std::max(1.0, height_px));
  corner_->SetViewport(0.0, 0.0, width, height);
  constexpr double kDistance = 4.0;  // of a cube of side 1
  vtkCamera& eye = *corner_->GetActiveCamera();
  eye.SetPosition(Vec3(-kDistance * camera.forward()).data());
  eye.SetFocalPoint(0.0, 0.0, 0.0);
  eye.SetViewUp(Vec3(camera.up()).data());
  eye.SetParallelScale(1.0);
  eye.SetClippingRange(0.5 * kDistance, 1.5 * kDistance);
}

}  // namespace spinaltap

#include "apps/spinaltap-planner/scene/kept_layer.h"

#include <vtk_glew.h>
// OpenGL before those.
#include <vtkOpenGLFramebufferObject.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>

#include <array>

namespace spinaltap {
namespace {

void copy(vtkOpenGLRenderWindow& window, vtkOpenGLFramebufferObject& from, vtkOpenGLFramebufferObject& to) {
  const int* size = window.GetSize();
  const std::array<int, 4> all{0, size[0], 0, size[1]};
  vtkOpenGLState& state = *window.GetState();
  state.PushFramebufferBindings();
  from.Bind(GL_READ_FRAMEBUFFER);
  from.ActivateReadBuffer(0);
  to.Bind(GL_DRAW_FRAMEBUFFER);
  to.ActivateDrawBuffer(0);
  vtkOpenGLFramebufferObject::Blit(all.data(), all.data(), GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  state.PopFramebufferBindings();
}

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

}  // namespace spinaltap

#pragma once

// VTK's classes by name, for headers: its own headers take long to compile. Their destructors are protected, since VTK
// counts references.
// NOLINTBEGIN(cppcoreguidelines-virtual-class-destructor)
class vtkActor;
class vtkCamera;
class vtkMatrix4x4;
class vtkOpenGLFramebufferObject;
class vtkOpenGLRenderWindow;
class vtkPolyData;
class vtkRenderWindow;
class vtkRenderer;
// NOLINTEND(cppcoreguidelines-virtual-class-destructor)

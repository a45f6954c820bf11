#pragma once

#include <string>

#include "core/base/geometry.h"
#include "core/base/image.h"
#include "core/ct/ct_volume.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// The three standard planes, as radiologists look at them: axial from the feet (patient's left on the right, anterior
/// up), coronal from the front (left on the right, superior up), sagittal from the patient's left (anterior on the
/// left, superior up).
enum class Plane { kAxial, kCoronal, kSagittal };

/// Where the pixels of a planar picture lie in the patient. Pixel (column, row) has its centre on integers, row 0 on
/// top; the third pixel coordinate is the depth away from the viewer, in pixels too.
struct SliceFrame {
  Vec3 origin_mm = Vec3::Zero();  ///< centre of pixel (0, 0), patient LPS
  Vec3 right = Vec3::UnitX();     ///< unit, patient LPS, along which columns grow
  Vec3 down = Vec3::UnitY();      ///< unit, patient LPS, along which rows grow
  double pixel_mm = 0.2;          ///< step of columns and rows
  int width = 0;                  ///< columns
  int height = 0;                 ///< rows

  /// Unit, patient LPS, away from the viewer.
  Vec3 into() const { return right.cross(down); }
  /// Column, row and depth (all in pixels) of a patient position (mm).
  Vec3 to_pixel(const Vec3& p_patient) const;
  /// Patient position (mm) of a column, row and depth (pixels).
  Vec3 to_patient(const Vec3& p_pixel) const;
};

/// The frame of the standard plane through `through_mm` (patient LPS), cropped to `crop_mm` (patient LPS).
/// Throws Error when the crop is empty, not finite, or would need more than 4096 pixels a side.
SliceFrame plane_frame(Plane plane, const Vec3& through_mm, const Box3& crop_mm, double pixel_mm = 0.2);

/// The frame of the plane that holds the whole path and, of those, lies closest to axial; cropped to the part of
/// `crop_mm` that it cuts. A path along the body's long axis gets the sagittal plane. Throws as plane_frame() does.
SliceFrame path_frame(const DrillPath& path, const Box3& crop_mm, double pixel_mm = 0.2);

/// The same plane with at least `width` columns and `height` rows, grown evenly to all sides.
SliceFrame grown_to(const SliceFrame& frame, int width, int height);

/// Letters of a direction (patient LPS): "L", or "LA" where a second axis is more than 22.5 degrees away from zero,
/// strongest first. L, R: left, right; A, P: anterior, posterior; S, I: superior, inferior.
std::string orientation_letters(const Vec3& direction);

/// Which HU are black and which white. The default is a bone window.
struct HuWindow {
  double width_hu = 1800.0;  ///< white minus black
  double level_hu = 500.0;   ///< mid-grey
};

/// A picture of a CT along a plane, with the mapping between its pixels and the patient.
struct CtSlice {
  Image image;  ///< grey, frame.width by frame.height
  SliceFrame frame;
};

/// The CT along the plane of `frame`, tri-linearly interpolated at the pixel centres, for a grid of any orientation.
/// Black outside the CT. Throws Error when the window's width is not above 0.
CtSlice ct_slice(const CtVolume& ct, const SliceFrame& frame, const HuWindow& window = {});

}  // namespace spinaltap

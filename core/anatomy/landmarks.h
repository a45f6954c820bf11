#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/progress.h"

namespace spinaltap {

class BoneShape;

/// A pedicle at its isthmus, the narrowest section between the vertebra's arch and its body. Patient LPS, mm.
struct PedicleLandmarks {
  Vec3 isthmus_mm = Vec3::Zero();    ///< centre of the narrowest section
  Vec3 axis = -Vec3::UnitY();        ///< unit, from the back to the front, at right angles to that section
  Vec3 width_axis = Vec3::UnitX();   ///< unit, the section's principal axis that is nearer to the patient's left
  Vec3 height_axis = Vec3::UnitZ();  ///< unit, the other one, upward
  double width_mm = 0.0;             ///< the section's extent along width_axis
  double height_mm = 0.0;            ///< and along height_axis
};

/// An endplate of the vertebral body, as the plane that lies best among its points.
struct EndplateLandmarks {
  Vec3 centre_mm = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit, out of the body
};

/// Parts of a vertebra, as an instrument meets them.
enum class VertebraPart {
  body,
  pedicle,
  lamina,
  spinous_process,
  transverse_process,
  superior_articular_process,
  superior_joint,  ///< the joint surface of the superior articular process
  inferior_articular_process,
  other_vertebra  ///< a neighbour's, whatever its part
};
/// "superior articular process".
const char* name_of(VertebraPart part);

/// What was found on a lumbar or thoracic vertebra. Patient LPS, mm.
struct Landmarks {
  /// The vertebra's own frame: columns are its left, its back and its top (unit, right-handed), as patient LPS.
  Mat3 axes = Mat3::Identity();
  /// Its origin: the canal's centre at the height of the pedicles' isthmuses, in the midsagittal plane, which goes
  /// through it with the normal left().
  Vec3 origin_mm = Vec3::Zero();
  Vec3 left() const { return axes.col(0); }
  Vec3 posterior() const { return axes.col(1); }
  Vec3 superior() const { return axes.col(2); }
  /// A place of the patient (LPS, mm) in the vertebra's own frame, mm, and back.
  Vec3 to_own(const Vec3& p_patient) const;
  Vec3 to_patient(const Vec3& p_own) const;

  struct Canal {
    Vec3 centre_mm = Vec3::Zero();  ///< where it is narrowest
    Vec3 axis = Vec3::UnitZ();      ///< unit, upward
    double width_mm = 0.0;          ///< side to side, at the pedicles
    double depth_mm = 0.0;          ///< front to back, in the midsagittal plane
  } canal;
  /// Of each of BoneShape::points_mm(): 1 on the canal's wall, 0 on the outer surface.
  std::vector<std::uint8_t> is_canal_wall;

  struct Body {
    Vec3 centre_mm = Vec3::Zero();
    double width_mm = 0.0;   ///< side to side, at its waist
    double depth_mm = 0.0;   ///< front to back, in the midsagittal plane
    double height_mm = 0.0;  ///< between the endplates' centres
    EndplateLandmarks upper, lower;
  } body;

  PedicleLandmarks left_pedicle, right_pedicle;  ///< the patient's left and right

  /// What looks unlike a vertebra, one line each; empty when sure.
  std::vector<std::string> warnings;
};

/// Finds the landmarks from the shape alone, however the vertebra is tilted, as long as its top is nearer to the
/// patient's than to any other side. Throws Error, which says what is missing or too many, where there is not one whole
/// vertebra: no canal, a pedicle or the body cut away, or two vertebrae.
Landmarks find_landmarks(const BoneShape& bone, const Progress& progress = {});

}  // namespace spinaltap

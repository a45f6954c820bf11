#pragma once

#include <string>
#include <vector>

#include "core/anatomy/landmarks.h"
#include "core/anatomy/surface_sample.h"

namespace spinaltap {

/// A flat face beyond which there is no bone: where a bone was cut off, by a crop or the end of a CT.
struct CutFace {
  double area_mm2 = 0.0;
  Vec3 normal = Vec3::UnitZ();  ///< unit, outward
};

/// The largest cut face; area 0 without any.
CutFace find_cut_face(const SurfaceSample& surface);

/// Volumes of the pieces that do not touch each other, mm³, the largest first.
std::vector<double> piece_volumes_mm3(const BoneShape& bone);

/// The patient's side that a direction points to: "left", "right", "back", "front", "top" or "bottom".
const char* side_of_patient(const Vec3& direction);

/// What is unusual for a thoracic or lumbar vertebra, one line each, with the figure and what was expected.
/// `asymmetry_mm`: median distance between the surface and its mirror image.
std::vector<std::string> warnings_about(const Landmarks& found, double asymmetry_mm, const CutFace& cut_face);

}  // namespace spinaltap

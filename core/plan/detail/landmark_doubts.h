#pragma once

#include <string>
#include <vector>

#include "core/plan/detail/whole_bone.h"
#include "core/plan/landmarks.h"

namespace spinaltap {

/// What is unusual for a thoracic or lumbar vertebra, one line each, with the figure and what was expected.
/// `asymmetry_mm`: median distance between the surface and its mirror image.
std::vector<std::string> doubts_about(const Landmarks& found, double asymmetry_mm, const CutFace& cut_face);

}  // namespace spinaltap

#pragma once

#include "core/anatomy/landmarks.h"
#include "core/files/json_file.h"
#include "core/plan/suggest.h"

namespace spinaltap {

/// Landmarks, patient LPS; docs/planning.md lists the keys.
Json to_json(const Landmarks& landmarks);
/// A side's path with its screw, angles and safe zone, or why there is none.
Json to_json(const Suggestion& suggestion);

}  // namespace spinaltap

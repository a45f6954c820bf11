#pragma once

#include <string>

#include "core/anatomy/landmarks.h"

namespace spinaltap {

/// Landmarks as JSON on one line, patient LPS; docs/planning.md lists the keys. A bone's notes hold them so.
std::string landmarks_text(const Landmarks& landmarks);

}  // namespace spinaltap

#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/image.h"
#include "tests/trunks/trunk_exam.h"

namespace spinaltap::test {

/// A level that is missed or wrong: axial, coronal and sagittal through the true middle of its body, the truth outlined
/// in blue, what was found in orange, dashed.
Image failure_picture(const TrunkExam& exam, const WholeLevelScore& level);

/// Pictures below each other, each under its caption.
Image captioned(const std::vector<std::pair<Image, std::string>>& pictures);

}  // namespace spinaltap::test

#pragma once

namespace spinaltap {

/// Work whose results are kept, and are not to be taken for those of other code.
enum class CodeStage {
  mask,     ///< from a CT to the mask of a vertebra
  fit,      ///< from mask and CT to the fitted surface
  drilling  ///< from a baked bone to what a drilling comes to
};

/// A fingerprint of the sources that a stage's results follow from, as they were when the library was built: 16
/// hexadecimal digits. The same in every build of the same sources.
const char* code_fingerprint(CodeStage stage);

}  // namespace spinaltap

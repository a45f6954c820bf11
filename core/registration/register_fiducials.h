#pragma once

#include <span>

#include "core/registration/registration.h"

namespace spinaltap {

struct FiducialOptions {
  /// How marks are located: root mean square of their distance from where they are (the FLE), of both frames together,
  /// mm; 0: not known, found from the residuals.
  double fle_mm = 0.0;
  double max_slide_mm = 1.0;  ///< a motion of the marks that may be larger, one deviation, is warned of
};

/// From marks in the CT (patient LPS, mm) and the same marks, in the same order, as a tracker measured them on the
/// patient. Pose: Horn 1987, see fit_pose(). FLE from FRE: Fitzpatrick, West & Maurer, "Predicting error in rigid-body
/// point-based registration", IEEE Trans. Med. Imaging 1998: the FRE's mean square is (1 - 2/N) of the FLE's. Errors
/// of targets, by place and direction: the covariance of least squares, whose trace is that paper's and whose parts are
/// those of Fitzpatrick & West, "The distribution of target registration error in rigid-body point-based registration",
/// IEEE Trans. Med. Imaging 2001. Throws Error on fewer than 3 marks, marks that are not finite or over a metre apart,
/// and marks on one line, which hold no turn about it.
Registration register_fiducials(std::span<const Vec3> ct_mm, std::span<const Vec3> patient_mm,
                                const FiducialOptions& options = {});

}  // namespace spinaltap

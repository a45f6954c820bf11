#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

struct Landmarks;

/// How two numbers scatter across a path: towards the midsagittal plane (medial) and upward (cranial), in the
/// vertebra's own frame. Their law: a standard normal vector whose length is replaced by one of a Weibull law, so that
/// lengths have the tail that was measured; a shape of 2 leaves them normal.
struct CrossErrors {
  double medial_bias = 0.0;   ///< mean
  double cranial_bias = 0.0;  ///< mean
  double medial = 0.0;        ///< standard deviation
  double cranial = 0.0;       ///< standard deviation
  double shape = 2.0;         ///< of the length's Weibull law: below 2 a heavier tail than normal, above a thinner
};

/// One screw's error.
struct PlacementError {
  double medial_mm = 0.0, cranial_mm = 0.0;  ///< of the entry
  double along_mm = 0.0;                     ///< of the entry, along the path: too deep
  double medial_deg = 0.0, cranial_deg = 0.0;
};

/// All of a screw's error at one go: mean and covariance of its numbers, in PlacementError's order. Normal, but for
/// what follows.
struct JointErrors {
  std::array<double, 5> mean{};
  std::array<std::array<double, 5>, 5> covariance{};
  /// Truncated: no error lies further from the mean than this many deviations, as Mahalanobis measures them.
  double most_deviations = std::numeric_limits<double>::infinity();
  /// Heavy tails: so large a share of the screws errs so many times as much (Tukey 1960).
  double outlier_share = 0.0;
  double outlier_times = 1.0;
};

/// How far screws end from where they were planned. docs/placement-errors.md has the model and the shipped ones.
struct PlacementErrors {
  std::string name;  ///< "robot_726", or "1.5 mm, 2 degrees"
  std::string title;
  std::vector<std::string> sources;
  CrossErrors entry_mm;       ///< of the entry, where the screw's head is: it shifts the whole path
  CrossErrors direction_deg;  ///< of the path's direction, turned about the entry
  double along_bias_mm = 0.0;
  double along_mm = 0.0;  ///< standard deviation of how much too deep the screw stands; normal
  /// Of the entry's error with the direction's to the same side, of the normal numbers behind both: -1 to 1. Below 0
  /// the tip errs less than both would make it.
  double correlation = 0.0;
  /// In place of all of these, where they are given: a joint law, or a table of errors as they were measured, from
  /// which each screw has one.
  std::optional<JointErrors> joint = {};
  std::vector<PlacementError> measured = {};
};

/// Throws Error on what is not finite, spreads below 0 or over 100, shapes out of 0.5 to 50, correlations out of -1 to
/// 1, and on what is no covariance.
void check_errors(const PlacementErrors& errors);

/// Isotropic, normal: standard deviations of the entry to each side (mm) and of the direction (degrees), without bias
/// or correlation. Throws Error as check_errors() does.
PlacementErrors plain_errors(double entry_mm, double direction_deg);

/// Mean and standard deviation of a distance (or an angle), as series of screws publish them.
struct MeanAndDeviation {
  double mean = 0.0;
  double deviation = 0.0;
};
/// An isotropic law whose length has that mean and that deviation. Throws Error where there is none: on means and
/// deviations that are not above 0, and on a mean of less than 0.5 or over 40 deviations.
CrossErrors errors_of_length(const MeanAndDeviation& length);

/// Median and 95th percentile of an error's size to one side and its opposite.
struct MedianAndP95 {
  double median = 0.0;
  double p95 = 0.0;
};
/// A law with these: each size as near as one shape for both lets it come, median and percentile off by the same
/// factor. Throws Error on medians not above 0 and percentiles of less than 2 or over 20 medians.
CrossErrors errors_of_sides(const MedianAndP95& medial, const MedianAndP95& cranial);

/// The correlation with which the tip of a screw errs, on the root mean square, as it was measured. Throws Error where
/// no correlation fits.
double correlation_by_tip(const CrossErrors& entry_mm, const CrossErrors& direction_deg, const MeanAndDeviation& tip_mm,
                          double screw_length_mm);

/// Draw number `index` of a scrambled Sobol sequence: the same whatever thread asks.
PlacementError draw_error(const PlacementErrors& errors, std::uint64_t seed, std::uint32_t index);
/// From six standard normal numbers: entry medial and cranial, direction medial and cranial, along, and whether it is
/// an outlier. Of a joint law the entry's are behind the entry alone, the direction's behind what of the direction does
/// not go with it, and the fifth behind what of the depth goes with neither. Of a table the first chooses the row.
PlacementError error_of(const PlacementErrors& errors, const std::array<double, 6>& normals);
/// The same, with the entry's part and the direction's so many times as large.
PlacementError scaled(const PlacementError& error, double entry, double direction);

/// The directions of a path's errors: unit, at right angles, patient LPS.
struct ErrorFrame {
  Vec3 medial = Vec3::UnitX();
  Vec3 cranial = Vec3::UnitZ();
  Vec3 along = -Vec3::UnitY();
};
/// Medial is towards the midsagittal plane as seen from the pedicle that is nearer to the path, across the path.
ErrorFrame error_frame(const Landmarks& landmarks, const DrillPath& path);

/// The path with an error: shifted, then turned about its entry.
DrillPath erred_path(const DrillPath& path, const ErrorFrame& frame, const PlacementError& error);
/// The error with which erred_path() makes `erred` of `path`, whatever moved it.
PlacementError error_between(const DrillPath& path, const ErrorFrame& frame, const DrillPath& erred);

}  // namespace spinaltap

#include "core/ct/detail/dicom_stack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>

#include "core/base/error.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

// Positions are decimals that scanners round to 0.01 mm and finer. Steps may differ by what rounding explains (a little
// over 0.01 mm), or by 1%.
constexpr double kStepToleranceMm = 0.011;
constexpr double kStepTolerance = 0.01;
constexpr double kMaxShiftMm = 0.05;  // sideways, from one slice to the next
constexpr double kMaxGapMm = 6.0;     // across which slices are interpolated
constexpr double kMaxTilt = 0.79;     // rad, 45 degrees: gantries tilt by 30
constexpr double kMaxDirectionError = 1e-3;

struct Placed {
  SlicePlace place;  ///< against the first slice
  double along_mm;   ///< position along the normal, from the patient's origin
  DicomHeader header;
};

std::string name_of(const Placed& slice) { return name_of(slice.header); }

void expect_numbers(const std::vector<double>& values, std::size_t count, const char* attribute,
                    const DicomHeader& header) {
  if (values.size() != count) {
    fail("expected ", count, " numbers in ", attribute, ", found ", values.size(), " in ", path_of(header));
  }
  for (const double value : values) {
    if (!std::isfinite(value)) {
      fail("expected ", count, " numbers in ", attribute, ", found one that is not a number in ", path_of(header));
    }
  }
}

/// Unit vectors at right angles; the third is the normal. Files round directions, so they are made exact here.
Mat3 directions_of(const DicomHeader& header) {
  expect_numbers(header.orientation, 6, "ImageOrientationPatient", header);
  const Vec3 i = Vec3(header.orientation[0], header.orientation[1], header.orientation[2]);
  const Vec3 j = Vec3(header.orientation[3], header.orientation[4], header.orientation[5]);
  if (!(std::abs(i.norm() - 1.0) < kMaxDirectionError) || !(std::abs(j.norm() - 1.0) < kMaxDirectionError) ||
      !(std::abs(i.dot(j)) < kMaxDirectionError)) {
    fail("expected ImageOrientationPatient to hold two unit vectors at right angles, found (", i.transpose(), ") and (",
         j.transpose(), ") in ", path_of(header));
  }
  Mat3 directions;
  directions.col(0) = i.normalized();
  directions.col(1) = (j - directions.col(0) * directions.col(0).dot(j)).normalized();
  directions.col(2) = directions.col(0).cross(directions.col(1));
  return directions;
}

void check_pixel_spacing(const DicomHeader& header, const DicomHeader& first) {
  if (header.pixel_spacing_mm.size() != 2) {
    fail("expected 2 numbers in PixelSpacing, found ", header.pixel_spacing_mm.size(), " in ", path_of(header));
  }
  for (std::size_t n = 0; n < 2; ++n) {
    const double spacing_mm = header.pixel_spacing_mm[n];
    if (!(spacing_mm > 0.0) || !std::isfinite(spacing_mm)) {
      fail("expected PixelSpacing above 0 mm, found ", spacing_mm, " in ", path_of(header));
    }
    if (spacing_mm >= kMaxPixelMm) {
      fail("expected PixelSpacing below ", kMaxPixelMm, " mm, found ", spacing_mm, " in ", path_of(header));
    }
    if (!(std::abs(spacing_mm - first.pixel_spacing_mm[n]) <= 1e-4 * first.pixel_spacing_mm[n])) {
      fail("expected PixelSpacing ", first.pixel_spacing_mm[n], " mm as in ", name_of(first), ", found ", spacing_mm,
           " mm in ", path_of(header));
    }
  }
}

Vec3 position_of(const DicomHeader& header) {
  expect_numbers(header.position_mm, 3, "ImagePositionPatient", header);
  return {header.position_mm[0], header.position_mm[1], header.position_mm[2]};
}

std::vector<Placed> place(std::vector<DicomHeader> headers, const Mat3& directions) {
  if (headers.size() < 2) {
    fail("expected at least two slices, found ", headers.size(),
         headers.empty() ? std::string() : ": " + path_of(headers.front()));
  }
  std::vector<Placed> placed;
  for (DicomHeader& header : headers) {
    const double along_mm = directions.col(2).dot(position_of(header));
    placed.push_back({{}, along_mm, std::move(header)});
  }
  std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    if (a.along_mm != b.along_mm) return a.along_mm < b.along_mm;
    return std::tie(a.header.file, a.header.frame) < std::tie(b.header.file, b.header.frame);
  });
  const Vec3 first = position_of(placed.front().header);
  for (Placed& slice : placed) {
    const Vec3 move = directions.transpose() * (position_of(slice.header) - first);
    slice.place = {slice.along_mm - placed.front().along_mm, move.head<2>()};
  }
  return placed;
}

/// Of two in the middle the lower: gaps lengthen steps.
double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The files state decimals: takes off what binary subtraction added, so that 1.5 mm is 1.5.
double without_dust(double value_mm) { return std::round(value_mm * 1e9) * 1e-9; }

struct Steps {
  double step_mm;      ///< of the grid
  bool are_unequal;    ///< slices must be interpolated
  std::string note{};  ///< what was assumed
};

/// Whether all positions are whole multiples of `grain_mm`, as where a program wrote few digits.
bool are_multiples_of(double grain_mm, const std::vector<Placed>& slices) {
  return std::all_of(slices.begin(), slices.end(), [&](const Placed& slice) {
    return std::all_of(slice.header.position_mm.begin(), slice.header.position_mm.end(), [&](double value_mm) {
      const double grains = value_mm / grain_mm;
      return std::abs(grains - std::round(grains)) < 1e-4;
    });
  });
}

/// The even step that explains all places, each rounded to 0.1 mm; nothing where there is none. Of all such steps the
/// one that the files state, else the one in the middle.
std::optional<double> step_of_rounded(const std::vector<Placed>& slices, const Vec3& normal) {
  constexpr double kGrainMm = 0.1;
  constexpr double kMaxGrainOfStep = 0.35;  // beyond, rounding would explain anything
  if (slices.size() < 4 || !are_multiples_of(kGrainMm, slices)) return std::nullopt;
  const double mean_mm = slices.back().place.along_mm / static_cast<double>(slices.size() - 1);
  if (!(kGrainMm < kMaxGrainOfStep * mean_mm)) return std::nullopt;
  const double off_mm = 2.0 * (0.5 * kGrainMm * normal.cwiseAbs().sum() + 1e-6);  // of two places against each other
  double least = 0.0, most = std::numeric_limits<double>::max();
  for (std::size_t last = 1; last < slices.size(); ++last) {
    for (std::size_t first = 0; first < last; ++first) {
      const double apart_mm = slices[last].along_mm - slices[first].along_mm;
      const auto steps = static_cast<double>(last - first);
      least = std::max(least, (apart_mm - off_mm) / steps);
      most = std::min(most, (apart_mm + off_mm) / steps);
    }
  }
  if (!(least <= most)) return std::nullopt;
  const DicomHeader& first = slices.front().header;
  const std::vector<double>& stated =
      first.slice_spacing_mm.empty() ? first.slice_thickness_mm : first.slice_spacing_mm;
  const bool is_stated = stated.size() == 1 && stated.front() >= least && stated.front() <= most;
  return is_stated ? stated.front() : 0.5 * (least + most);
}

/// Checks each step against the usual one. Where all agree, the mean is the grid's: over many slices it is more exact
/// than any one. Where they do not and `resample` is set, the usual one.
Steps judge_steps(const std::vector<Placed>& slices, const Vec3& normal, bool resample) {
  std::vector<double> steps_mm;
  for (std::size_t k = 1; k < slices.size(); ++k) steps_mm.push_back(slices[k].along_mm - slices[k - 1].along_mm);
  const double usual_mm = median(steps_mm);
  const double tolerance_mm = std::max(kStepTolerance * usual_mm, kStepToleranceMm);
  const bool are_even = std::all_of(steps_mm.begin(), steps_mm.end(),
                                    [&](double step_mm) { return std::abs(step_mm - usual_mm) <= tolerance_mm; });
  if (!are_even) {
    if (const std::optional<double> step_mm = step_of_rounded(slices, normal)) {
      return {without_dust(*step_mm), false,
              joined("positions are rounded to 0.1 mm: taken for even steps of ", without_dust(*step_mm), " mm")};
    }
  }
  bool are_unequal = false;
  for (std::size_t k = 1; k < slices.size(); ++k) {
    const double step_mm = steps_mm[k - 1];
    if (!(step_mm > 1e-4) || step_mm < 0.05 * usual_mm) {
      fail("expected one slice at each position, found two at ", slices[k].along_mm, " mm: ", name_of(slices[k - 1]),
           " and ", path_of(slices[k].header));
    }
    if (std::abs(step_mm - usual_mm) <= tolerance_mm && step_mm < 1.5 * usual_mm) continue;
    are_unequal = true;
    if (resample && step_mm <= kMaxGapMm) continue;
    const double count = std::round(step_mm / usual_mm);
    const bool is_gap = count >= 2.0 && std::abs(step_mm - count * usual_mm) <= std::max(0.1 * usual_mm, tolerance_mm);
    TextWriter found;
    found << (is_gap ? (count > 2.0 ? "slices are missing" : "a slice is missing") : "slices are unevenly spaced")
          << ": expected a step of " << usual_mm << " mm, found " << step_mm << " mm between " << name_of(slices[k - 1])
          << " and " << path_of(slices[k].header);
    if (!resample && step_mm <= kMaxGapMm) throw UnevenSlices(found.str(), "CtReadOptions::resample interpolates");
    if (resample) found << ", which is more than the " << kMaxGapMm << " mm across which slices are interpolated";
    throw Error(found.str());
  }
  const double mean_mm = slices.back().place.along_mm / static_cast<double>(slices.size() - 1);
  return {without_dust(are_unequal ? usual_mm : mean_mm), are_unequal};
}

double tilt_of(const std::vector<Placed>& slices) {
  return std::atan2(slices.back().place.sideways_mm.norm(), slices.back().place.along_mm);
}

/// Whether slices stand so far beside each other that they must be shifted. An even drift is a tilted gantry's; an
/// uneven one is rejected without `resample`.
bool judge_drift(const std::vector<Placed>& slices, double pixel_mm, bool resample) {
  const double tolerance_mm = std::max(0.5 * pixel_mm, kMaxShiftMm);
  const Placed& last = slices.back();
  const Eigen::Vector2d slope = last.place.sideways_mm / last.place.along_mm;
  bool is_straight = true;
  bool is_even = true;
  std::size_t worst = 1;
  for (std::size_t k = 1; k < slices.size(); ++k) {
    const Eigen::Vector2d from_first_mm = slices[k].place.sideways_mm;
    const double from_last_mm = (from_first_mm - slices[k - 1].place.sideways_mm).norm();
    const double from_line_mm = (from_first_mm - slope * slices[k].place.along_mm).norm();
    const bool stands_over = from_first_mm.norm() <= tolerance_mm && from_last_mm <= kMaxShiftMm;
    if (is_straight && !stands_over) worst = k;
    is_straight = is_straight && stands_over;
    is_even = is_even && from_line_mm <= kMaxShiftMm;
  }
  if (is_straight) return false;
  if (!(tilt_of(slices) < kMaxTilt)) {
    fail("expected slices stacked along their normal or a gantry tilted by less than 45 degrees, found ",
         tilt_of(slices) * 180.0 / std::numbers::pi, " degrees in ", slices.front().header.file.parent_path().string());
  }
  if (!is_even && !resample) {
    TextWriter found;
    found << "expected slices stacked along their normal, found " << path_of(slices[worst].header)
          << " shifted sideways by " << (slices[worst].place.sideways_mm - slices[worst - 1].place.sideways_mm).norm()
          << " mm from the slice before and " << slices[worst].place.sideways_mm.norm() << " mm from the first";
    throw UnevenSlices(found.str(), "CtReadOptions::resample shifts them back");
  }
  return true;
}

}  // namespace

DicomStack stack_slices(std::vector<DicomHeader> headers, bool resample) {
  if (headers.empty()) fail("expected at least two slices, found 0");
  const Mat3 directions = directions_of(headers.front());
  for (const DicomHeader& header : headers) check_pixel_spacing(header, headers.front());
  const std::vector<double> pixel_spacing_mm = headers.front().pixel_spacing_mm;

  std::vector<Placed> placed = place(std::move(headers), directions);
  const Steps steps = judge_steps(placed, directions.col(2), resample);
  const bool is_shifted = judge_drift(placed, std::min(pixel_spacing_mm[0], pixel_spacing_mm[1]), resample);

  DicomStack stack;
  const DicomHeader& first = placed.front().header;
  stack.geometry.size = {first.columns, first.rows, static_cast<int>(placed.size())};
  stack.geometry.origin_mm = position_of(first);
  stack.geometry.spacing_mm = Vec3(pixel_spacing_mm[1], pixel_spacing_mm[0], steps.step_mm);
  stack.geometry.directions = directions;
  check_geometry(stack.geometry, "CT");
  stack.needs_resampling = steps.are_unequal || is_shifted;
  stack.note = steps.note;
  for (std::size_t k = 0; k < placed.size(); ++k) {
    SlicePlace& at = stack.places.emplace_back(placed[k].place);
    // Steps that agree but for rounding, and shifts below tolerance, are none.
    if (!steps.are_unequal) at.along_mm = static_cast<double>(k) * steps.step_mm;
    if (!is_shifted) at.sideways_mm.setZero();
  }
  for (Placed& slice : placed) stack.slices.push_back(std::move(slice.header));
  return stack;
}

std::vector<Interval> made_up_slabs(const DicomStack& stack) {
  constexpr double kGap = 1.5;  // of a step: unequal steps below it leave no room for a slice
  const double step_mm = stack.geometry.spacing_mm.z();
  const double first_mm = stack.geometry.directions.col(2).dot(stack.geometry.origin_mm);
  std::vector<Interval> slabs_mm;
  for (std::size_t k = 1; k < stack.places.size(); ++k) {
    const double from_mm = stack.places[k - 1].along_mm, to_mm = stack.places[k].along_mm;
    if (to_mm - from_mm < kGap * step_mm) continue;
    slabs_mm.push_back({first_mm + from_mm + 0.5 * step_mm, first_mm + to_mm - 0.5 * step_mm});
  }
  return slabs_mm;
}

StackLayout measure_stack(const std::vector<DicomHeader>& slices) {
  if (slices.empty()) fail("expected at least two slices, found 0");
  StackLayout layout;
  layout.directions = directions_of(slices.front());
  const std::vector<Placed> placed = place(slices, layout.directions);
  layout.min_step_mm = layout.max_step_mm = without_dust(placed[1].along_mm - placed[0].along_mm);
  for (std::size_t k = 1; k < placed.size(); ++k) {
    const double step_mm = without_dust(placed[k].along_mm - placed[k - 1].along_mm);
    layout.min_step_mm = std::min(layout.min_step_mm, step_mm);
    layout.max_step_mm = std::max(layout.max_step_mm, step_mm);
  }
  layout.tilt_rad = tilt_of(placed);
  return layout;
}

}  // namespace spinaltap

#include "core/ct/dicom_stack.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

// Positions are decimals that scanners round to 0.01 mm and finer. Steps may differ by what rounding explains (a little
// over 0.01 mm), or by 1%.
constexpr double kStepToleranceMm = 0.011;
constexpr double kStepTolerance = 0.01;
constexpr double kMaxShiftMm = 0.05;  // sideways, from one slice to the next
constexpr double kMaxDirectionError = 1e-3;

struct Placed {
  double along_mm;  ///< position along the normal
  Vec3 p_patient;   ///< ImagePositionPatient, mm
  DicomHeader header;
};

std::string name_of(const Placed& slice) { return slice.header.file.filename().string(); }

void expect_numbers(const std::vector<double>& values, std::size_t count, const char* attribute,
                    const DicomHeader& header) {
  if (values.size() != count) {
    fail("expected ", count, " numbers in ", attribute, ", found ", values.size(), " in ", header.file.string());
  }
  for (const double value : values) {
    if (!std::isfinite(value)) {
      fail("expected ", count, " numbers in ", attribute, ", found one that is not a number in ", header.file.string());
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
         j.transpose(), ") in ", header.file.string());
  }
  Mat3 directions;
  directions.col(0) = i.normalized();
  directions.col(1) = (j - directions.col(0) * directions.col(0).dot(j)).normalized();
  directions.col(2) = directions.col(0).cross(directions.col(1));
  return directions;
}

void check_pixel_spacing(const DicomHeader& header, const DicomHeader& first) {
  if (header.pixel_spacing_mm.size() != 2) {
    fail("expected 2 numbers in PixelSpacing, found ", header.pixel_spacing_mm.size(), " in ", header.file.string());
  }
  for (std::size_t n = 0; n < 2; ++n) {
    const double spacing_mm = header.pixel_spacing_mm[n];
    if (!(spacing_mm > 0.0) || !std::isfinite(spacing_mm)) {
      fail("expected PixelSpacing above 0 mm, found ", spacing_mm, " in ", header.file.string());
    }
    if (!(std::abs(spacing_mm - first.pixel_spacing_mm[n]) <= 1e-4 * first.pixel_spacing_mm[n])) {
      fail("expected PixelSpacing ", first.pixel_spacing_mm[n], " mm as in ", first.file.filename().string(),
           ", found ", spacing_mm, " mm in ", header.file.string());
    }
  }
}

std::vector<Placed> place(std::vector<DicomHeader> headers, const Vec3& normal) {
  std::vector<Placed> placed;
  for (DicomHeader& header : headers) {
    expect_numbers(header.position_mm, 3, "ImagePositionPatient", header);
    const Vec3 p_patient(header.position_mm[0], header.position_mm[1], header.position_mm[2]);
    placed.push_back({normal.dot(p_patient), p_patient, std::move(header)});
  }
  std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    return a.along_mm != b.along_mm ? a.along_mm < b.along_mm : a.header.file < b.header.file;
  });
  return placed;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Checks each step against the usual one and gives the mean step, mm: over many slices it is more exact than any one.
double regular_step(const std::vector<Placed>& slices) {
  std::vector<double> steps_mm;
  for (std::size_t k = 1; k < slices.size(); ++k) steps_mm.push_back(slices[k].along_mm - slices[k - 1].along_mm);
  const double usual_mm = median(steps_mm);
  const double tolerance_mm = std::max(kStepTolerance * usual_mm, kStepToleranceMm);
  for (std::size_t k = 1; k < slices.size(); ++k) {
    const double step_mm = steps_mm[k - 1];
    if (!(step_mm > 1e-4) || step_mm < 0.05 * usual_mm) {
      fail("expected one slice at each position, found two at ", slices[k].along_mm, " mm: ", name_of(slices[k - 1]),
           " and ", slices[k].header.file.string());
    }
    if (std::abs(step_mm - usual_mm) <= tolerance_mm && step_mm < 1.5 * usual_mm) continue;
    const double count = std::round(step_mm / usual_mm);
    const bool is_gap = count >= 2.0 && std::abs(step_mm - count * usual_mm) <= std::max(0.1 * usual_mm, tolerance_mm);
    fail(is_gap ? (count > 2.0 ? "slices are missing" : "a slice is missing") : "slices are unevenly spaced",
         ": expected a step of ", usual_mm, " mm, found ", step_mm, " mm between ", name_of(slices[k - 1]), " and ",
         slices[k].header.file.string());
  }
  const double mean_mm = (slices.back().along_mm - slices.front().along_mm) / static_cast<double>(slices.size() - 1);
  // The files state decimals: take off what binary subtraction added, so that 1.5 mm is 1.5.
  return std::round(mean_mm * 1e9) * 1e-9;
}

void check_no_sideways_drift(const std::vector<Placed>& slices, const Vec3& normal, double step_mm, double pixel_mm) {
  const auto sideways_mm = [&](const Placed& from, const Placed& to) {
    const Vec3 move = to.p_patient - from.p_patient;
    return (move - normal * normal.dot(move)).norm();
  };
  const double per_slice_mm = sideways_mm(slices.front(), slices.back()) / static_cast<double>(slices.size() - 1);
  if (per_slice_mm > kMaxShiftMm) {
    fail("expected slices stacked along their normal, found them shifted sideways by ", per_slice_mm,
         " mm a slice (a gantry tilt of about ", std::atan2(per_slice_mm, step_mm) * 180.0 / std::numbers::pi,
         " degrees, which must be resampled away first) in ", slices.front().header.file.parent_path().string());
  }
  for (std::size_t k = 1; k < slices.size(); ++k) {
    const double shift_mm = std::max(sideways_mm(slices[k - 1], slices[k]) - kMaxShiftMm,
                                     sideways_mm(slices.front(), slices[k]) - std::max(0.5 * pixel_mm, kMaxShiftMm));
    if (shift_mm > 0.0) {
      fail("expected slices stacked along their normal, found ", slices[k].header.file.string(),
           " shifted sideways by ", sideways_mm(slices[k - 1], slices[k]), " mm from the slice before and ",
           sideways_mm(slices.front(), slices[k]), " mm from the first");
    }
  }
}

}  // namespace

DicomStack stack_slices(std::vector<DicomHeader> headers) {
  if (headers.size() < 2) {
    fail("expected at least two slices, found ", headers.size(),
         headers.empty() ? std::string() : ": " + headers.front().file.string());
  }
  const Mat3 directions = directions_of(headers.front());
  for (const DicomHeader& header : headers) check_pixel_spacing(header, headers.front());
  const std::vector<double> pixel_spacing_mm = headers.front().pixel_spacing_mm;

  const Vec3 normal = directions.col(2);
  std::vector<Placed> placed = place(std::move(headers), normal);
  const double step_mm = regular_step(placed);
  check_no_sideways_drift(placed, normal, step_mm, std::min(pixel_spacing_mm[0], pixel_spacing_mm[1]));

  DicomStack stack;
  const DicomHeader& first = placed.front().header;
  stack.geometry.size = {first.columns, first.rows, static_cast<int>(placed.size())};
  stack.geometry.origin_mm = placed.front().p_patient;
  stack.geometry.spacing_mm = Vec3(pixel_spacing_mm[1], pixel_spacing_mm[0], step_mm);
  stack.geometry.directions = directions;
  check_geometry(stack.geometry, "CT");
  for (Placed& slice : placed) stack.slices.push_back(std::move(slice.header));
  return stack;
}

}  // namespace spinaltap

#include "core/ct/detail/dicom_witnesses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/text_writer.h"
#include "core/ct/detail/dicom_slice.h"

namespace spinaltap {
namespace {

using Slices = std::vector<DicomHeader>;

/// How many of the values, in their order, grow from one to the next at most, with the others left out.
std::size_t longest_rise(const std::vector<double>& values) {
  std::vector<double> ends;  // of the rises of 1, 2, 3, ... values, the lowest
  for (const double value : values) {
    const auto at = std::lower_bound(ends.begin(), ends.end(), value);
    if (at == ends.end()) {
      ends.push_back(value);
    } else {
      *at = value;
    }
  }
  return ends.size();
}

/// Whether the values count evenly once they are sorted.
bool are_even(std::vector<double> values) {
  constexpr double kTolerance = 0.1;
  std::sort(values.begin(), values.end());
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  for (std::size_t n = 1; n < values.size(); ++n) {
    if (!(std::abs(values[n] - values[n - 1] - step) < kTolerance * step)) return false;
  }
  return step > 0.0;
}

/// The first of the slices, in the order of their positions, that stands elsewhere by what it counts.
void check_order(const Slices& slices, const char* name, std::vector<double> DicomHeader::*witness,
                 std::vector<std::string>& lines) {
  constexpr std::size_t kLeast = 4;
  constexpr double kLeastInOrder = 0.6;
  if (slices.size() < kLeast) return;
  std::vector<double> values;
  for (const DicomHeader& slice : slices) {
    if ((slice.*witness).size() != 1 || !std::isfinite((slice.*witness).front())) return;
    values.push_back((slice.*witness).front());
  }
  if (!are_even(values)) return;
  std::vector<double> turned = values;
  for (double& value : turned) value = -value;
  if (longest_rise(turned) > longest_rise(values)) values = std::move(turned);
  const std::size_t in_order = longest_rise(values);
  if (in_order == slices.size() || static_cast<double>(in_order) < kLeastInOrder * static_cast<double>(slices.size())) {
    return;
  }
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  std::size_t first = 0;
  while (values[first] == sorted[first]) ++first;
  lines.push_back(joined(slices.size() - in_order, " of ", slices.size(), " slices do not stand where ", name,
                         " counts them, the first of them slice ", first + 1,
                         " from its end: their positions may have changed places"));
}

void check_step(const DicomStack& stack, std::vector<std::string>& lines) {
  const double step_mm = stack.geometry.spacing_mm.z();
  const DicomHeader& first = stack.slices.front();
  const DicomHeader& last = stack.slices.back();
  constexpr double kTolerance = 0.02;
  if (first.slice_location_mm.size() == 1 && last.slice_location_mm.size() == 1) {
    // Along the patient's axis where slices are tilted: cosines down to that of 45 degrees.
    const double span_mm = std::abs(last.slice_location_mm.front() - first.slice_location_mm.front());
    const double located_mm = span_mm / static_cast<double>(stack.slices.size() - 1);
    const bool is_explained = located_mm > (1.0 - kTolerance) * step_mm && located_mm < (1.42 + kTolerance) * step_mm;
    if (located_mm > 0.0 && !(is_explained && (stack.needs_resampling || located_mm < (1.0 + kTolerance) * step_mm))) {
      lines.push_back(joined("positions are ", step_mm, " mm apart, SliceLocation counts ", located_mm,
                             " mm from slice to slice: distances along the body may be wrong"));
      return;
    }
  }
  if (first.slice_thickness_mm.size() != 1 || !(first.slice_thickness_mm.front() > 0.0)) return;
  const double thickness_mm = first.slice_thickness_mm.front();
  constexpr double kMostOverlap = 5.0, kMostGap = 2.1;
  if (thickness_mm > kMostOverlap * step_mm || step_mm > kMostGap * thickness_mm) {
    lines.push_back(joined("slices ", thickness_mm, " mm thick stand ", step_mm, " mm apart: ",
                           step_mm > thickness_mm ? "what lies between them was not seen" : "positions may be wrong"));
  }
}

/// Whether "LA" may stand for this direction (LPS): its first letter is the side that the direction leads to most.
bool names_direction(std::string_view letters, const Vec3& direction) {
  constexpr std::string_view kTo = "LPH", kFrom = "RAF";
  constexpr double kLeast = 0.5;
  if (letters.empty()) return true;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(axis);
    if (letters.front() == kTo[n]) return direction[axis] > kLeast;
    if (letters.front() == kFrom[n]) return direction[axis] < -kLeast;
  }
  return true;  // no letter of a body that lies there
}

void check_orientation(const DicomStack& stack, std::vector<std::string>& lines) {
  const Mat3& directions = stack.geometry.directions;
  for (const DicomHeader& slice : stack.slices) {
    const std::string_view all = slice.patient_orientation;
    const std::size_t between = all.find('\\');
    if (between == all.npos) continue;
    if (names_direction(all.substr(0, between), directions.col(0)) &&
        names_direction(all.substr(between + 1), directions.col(1))) {
      continue;
    }
    lines.push_back(joined("PatientOrientation says that pixels run to ", std::string(all.substr(0, between)), " and ",
                           std::string(all.substr(between + 1)),
                           ", ImageOrientationPatient says otherwise: left and right, or front and back, may be "
                           "exchanged"));
    return;
  }
}

void check_sizes(const DicomStack& stack, std::vector<std::string>& lines) {
  constexpr double kTolerance = 0.02;
  const GridGeometry& grid = stack.geometry;
  const double width_mm = grid.size[0] * grid.spacing_mm[0], height_mm = grid.size[1] * grid.spacing_mm[1];
  // Scanners make square pixels; programs that cut and resample do not always.
  const bool is_scanner = stack.slices.front().image_type.starts_with("ORIGINAL");
  const bool is_axial = is_scanner && std::abs(grid.directions(2, 2)) > 0.5 * std::numbers::sqrt3;
  if (is_axial &&
      std::abs(grid.spacing_mm[0] - grid.spacing_mm[1]) > kTolerance * grid.spacing_mm.head<2>().minCoeff()) {
    lines.push_back(joined("a scanner's axial pixels are not square: PixelSpacing ", grid.spacing_mm[1], " x ",
                           grid.spacing_mm[0], " mm"));
  }
  for (const DicomHeader& slice : stack.slices) {
    if (slice.reconstruction_mm.size() != 1 || !(slice.reconstruction_mm.front() > 0.0)) continue;
    const double diameter_mm = slice.reconstruction_mm.front();
    const double larger_mm = std::max(width_mm, height_mm);
    // Parts that were cut out are smaller; scanners make whole pictures of these sizes.
    constexpr std::array<int, 4> kWhole{256, 512, 768, 1024};
    const bool is_whole =
        grid.size[0] == grid.size[1] && std::find(kWhole.begin(), kWhole.end(), grid.size[0]) != kWhole.end();
    const bool is_too_large = larger_mm > (1.0 + kTolerance) * diameter_mm;
    const bool is_too_small = is_whole && larger_mm < (1.0 - kTolerance) * diameter_mm;
    if (!is_too_large && !is_too_small) continue;
    lines.push_back(joined("PixelSpacing makes a picture ", larger_mm, " mm wide, ReconstructionDiameter is ",
                           diameter_mm, " mm: sizes may be wrong by their proportion"));
    return;
  }
}

void check_drift(const DicomStack& stack, std::vector<std::string>& lines) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const SlicePlace& last = stack.places.back();
  const double drift_mm = last.sideways_mm.norm();
  if (!stack.needs_resampling || !(drift_mm > 0.0)) return;
  const double tilt_deg = std::atan2(drift_mm, last.along_mm) / kDegree;
  if (std::abs(last.sideways_mm.x()) > 0.1 * drift_mm &&
      std::abs(last.sideways_mm.x()) > stack.geometry.spacing_mm[0]) {
    lines.push_back(joined("slices drift along their rows, by ", last.sideways_mm.x(),
                           " mm in all, as no gantry tilts: ImagePositionPatient may be wrong"));
    return;
  }
  std::optional<double> stated_deg;
  for (const DicomHeader& slice : stack.slices) {
    if (slice.gantry_tilt_deg.size() == 1) stated_deg = std::abs(slice.gantry_tilt_deg.front());
  }
  if (stated_deg && std::abs(*stated_deg - tilt_deg) < 1.0) return;
  lines.push_back(
      joined("slices drift as if the gantry were tilted by ", tilt_deg, " degrees; GantryDetectorTilt says ",
             stated_deg ? joined(*stated_deg) : std::string("nothing"), ": they were put upright by their positions"));
}

/// Low numbers are air whatever they are, and none is measured above the highest.
void check_padding(const Slices& slices, std::vector<std::string>& lines) {
  constexpr double kLowestTissue = -900.0, kHighestTissue = 3000.0;
  for (const DicomHeader& slice : slices) {
    const std::optional<std::array<double, 2>> padded = padded_hu(slice);
    if (!padded || (*padded)[1] < kLowestTissue || (*padded)[0] > kHighestTissue) continue;
    lines.push_back(joined("PixelPaddingValue is a CT number that tissue has, ", (*padded)[0], " HU",
                           (*padded)[0] < (*padded)[1] ? joined(" to ", (*padded)[1]) : std::string(),
                           ": what has it was taken for air"));
    return;
  }
}

void check_bytes(const Slices& slices, std::vector<std::string>& lines) {
  const auto is_longer = [](const DicomHeader& h) { return h.surplus_bytes > 1; };
  const auto first = std::find_if(slices.begin(), slices.end(), is_longer);
  if (first == slices.end()) return;
  const auto longer = std::count_if(first, slices.end(), is_longer);
  lines.push_back(joined("PixelData is longer than Rows, Columns and BitsAllocated say, by ", first->surplus_bytes,
                         " bytes, in ", longer, " of ", slices.size(), " slices: sizes may be wrong"));
}

}  // namespace

std::vector<std::string> contradictions_of(const DicomStack& stack) {
  std::vector<std::string> lines;
  check_order(stack.slices, "SliceLocation", &DicomHeader::slice_location_mm, lines);
  check_order(stack.slices, "InstanceNumber", &DicomHeader::instance_number, lines);
  check_step(stack, lines);
  check_orientation(stack, lines);
  check_sizes(stack, lines);
  check_drift(stack, lines);
  check_padding(stack.slices, lines);
  check_bytes(stack.slices, lines);
  return lines;
}

}  // namespace spinaltap

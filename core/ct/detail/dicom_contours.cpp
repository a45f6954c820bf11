// DICOM structure sets: PS3.3, A.19 and C.8.8.5 to C.8.8.8.

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/ct/detail/dicom_labels.h"
#include "core/ct/detail/dicom_values.h"
#include "core/ct/detail/label_names.h"

namespace spinaltap::detail {
namespace {

namespace fs = std::filesystem;

struct Contour {
  std::string type;
  std::vector<double> stated_points;  ///< NumberOfContourPoints
  std::vector<Vec3> points;           ///< patient LPS, mm; later: index of the CT
};

struct Region {
  DicomSegment segment;
  std::vector<Contour> contours;
};

using Regions = std::map<long long, Region>;  // by ROI number

long long roi_number(DicomElementWalker& walker, const DicomElement& element) {
  const std::vector<double> number = dicom_decimals(walker.value(element));
  const bool is_number = number.size() == 1 && number.front() >= 0.0 && number.front() < 2147483648.0 &&
                         number.front() == std::floor(number.front());
  return is_number ? static_cast<long long>(number.front()) : -1;
}

void read_rois(DicomElementWalker& walker, const DicomElement& sequence, std::vector<DicomSegment>& rois) {
  constexpr std::size_t kMaxRois = 10'000;
  walker.items(sequence, [&](std::size_t item, const DicomElement& element) {
    if (item >= kMaxRois) fail("expected at most ", kMaxRois, " regions of interest, found more");
    if (rois.size() <= item) rois.resize(item + 1);
    if (element.tag == 0x30060022) {
      rois[item].number = roi_number(walker, element);
    } else if (element.tag == 0x30060026) {
      rois[item].label = dicom_text(walker.value(element));
    } else {
      walker.skip(element);
    }
  });
}

/// RTROIObservationsSequence: the code of what a region is.
void read_observations(DicomElementWalker& walker, const DicomElement& sequence, std::vector<DicomSegment>& seen) {
  constexpr std::size_t kMaxSeen = 10'000;
  walker.items(sequence, [&](std::size_t item, const DicomElement& element) {
    if (item >= kMaxSeen) fail("expected at most ", kMaxSeen, " observations of regions, found more");
    if (seen.size() <= item) seen.resize(item + 1);
    switch (element.tag) {
      case 0x30060084:
        seen[item].number = roi_number(walker, element);
        return;
      case 0x30060085:
        seen[item].description = dicom_text(walker.value(element));
        return;
      case 0x30060086:
        seen[item].type = read_code(walker, element);
        return;
      default:
        walker.skip(element);
    }
  });
}

std::vector<Vec3> points_of(DicomElementWalker& walker, const DicomElement& element, const fs::path& file) {
  constexpr std::uint32_t kMaxBytes = std::uint32_t{1} << 26;
  if (element.length > kMaxBytes)
    fail("expected contours of at most ", kMaxBytes, " bytes, found more in ", file.string());
  const std::vector<double> numbers = dicom_decimals(walker.value(element, kMaxBytes));
  const bool is_whole = numbers.size() % 3 == 0 && std::all_of(numbers.begin(), numbers.end(), [](double number) {
                          return std::abs(number) < 1e6;  // mm; false also for what is not a number
                        });
  if (!is_whole) {
    fail("expected contours of three numbers a point, found ", numbers.size(), " numbers, or other text, in ",
         file.string());
  }
  std::vector<Vec3> points;
  points.reserve(numbers.size() / 3);
  for (std::size_t n = 0; n < numbers.size(); n += 3) points.emplace_back(numbers[n], numbers[n + 1], numbers[n + 2]);
  return points;
}

/// A contour that lost points encloses something else.
void check_count(const Contour& contour, const fs::path& file) {
  if (contour.stated_points.empty() || contour.stated_points.front() == static_cast<double>(contour.points.size()))
    return;
  fail("expected a contour of as many points as NumberOfContourPoints, ", contour.stated_points.front(), ", found ",
       contour.points.size(), " in ", file.string());
}

/// ROIContourSequence: contours stand before or behind the number of the region that they are of.
void read_contours(DicomElementWalker& walker, const DicomElement& sequence, const fs::path& file,
                   std::map<long long, std::vector<Contour>>& contours) {
  std::vector<Contour> held;
  long long number = -1;
  std::size_t last_item = 0;
  const auto keep = [&] {
    std::vector<Contour>& known = contours[number];
    known.insert(known.end(), std::make_move_iterator(held.begin()), std::make_move_iterator(held.end()));
    held.clear();
    number = -1;
  };
  walker.items(sequence, [&](std::size_t item, const DicomElement& element) {
    if (item != last_item) keep();
    last_item = item;
    if (element.tag == 0x30060084) {
      number = roi_number(walker, element);
    } else if (element.tag == 0x30060040) {
      std::vector<Contour> found;
      walker.items(element, [&](std::size_t n, const DicomElement& part) {
        if (found.size() <= n) found.resize(n + 1);
        if (part.tag == 0x30060042) {
          found[n].type = dicom_text(walker.value(part));
        } else if (part.tag == 0x30060046) {
          found[n].stated_points = dicom_decimals(walker.value(part));
        } else if (part.tag == 0x30060050) {
          found[n].points = points_of(walker, part, file);
        } else {
          walker.skip(part);
        }
      });
      for (const Contour& contour : found) check_count(contour, file);
      held.insert(held.end(), std::make_move_iterator(found.begin()), std::make_move_iterator(found.end()));
    } else {
      walker.skip(element);
    }
  });
  keep();
}

Regions read_regions(const fs::path& file) {
  DicomElementWalker walker;
  if (!walker.open(file)) fail("expected a DICOM file, found one that is not: ", file.string());
  std::vector<DicomSegment> rois, seen;
  std::map<long long, std::vector<Contour>> contours;
  for (DicomElement element; walker.next(element);) {
    switch (element.tag) {
      case 0x00020010:
        walker.set_transfer_syntax(dicom_text(walker.value(element)));
        break;
      case 0x30060020:
        read_rois(walker, element, rois);
        break;
      case 0x30060039:
        read_contours(walker, element, file, contours);
        break;
      case 0x30060080:
        read_observations(walker, element, seen);
        break;
      default:
        walker.skip(element);
    }
  }
  Regions regions;
  for (const DicomSegment& roi : rois) {
    const auto [at, is_new] = regions.emplace(roi.number, Region{roi, {}});
    if (!is_new || roi.number < 0) {
      fail("expected regions of interest with numbers of their own, found ", roi.number, " twice or none in ",
           file.string());
    }
  }
  for (const DicomSegment& one : seen) {
    const auto roi = regions.find(one.number);
    if (roi == regions.end()) continue;
    if (roi->second.segment.type.value.empty()) roi->second.segment.type = one.type;
    if (roi->second.segment.description.empty()) roi->second.segment.description = one.description;
  }
  for (auto& [number, found] : contours) {
    const auto roi = regions.find(number);
    if (roi != regions.end()) {
      roi->second.contours = std::move(found);
    } else if (!found.empty()) {
      fail("expected contours of the regions that the file describes, found some of region ", number, " in ",
           file.string());
    }
  }
  return regions;
}

/// Leaves closed contours only. Points and open lines enclose nothing; a vertebra made of them is a mistake.
void keep_closed(Region& region, bool is_vertebra, const fs::path& file) {
  const auto is_closed = [](const Contour& contour) {
    return (contour.type == "CLOSED_PLANAR" || contour.type == "CLOSEDPLANAR_XOR") && contour.points.size() >= 3;
  };
  const std::size_t before = region.contours.size();
  const std::string other = before == 0 ? "" : region.contours.front().type;
  std::erase_if(region.contours, [&](const Contour& contour) { return !is_closed(contour); });
  if (is_vertebra && before > 0 && region.contours.empty()) {
    fail("expected closed planar contours of ", shown(region.segment.label), ", found ", in_quotes(other), " in ",
         file.string());
  }
}

/// The axis of the CT across which all contours are flat.
Eigen::Index flat_axis(const Regions& regions, const GridGeometry& ct, const fs::path& file) {
  Vec3 max_spread = Vec3::Zero();  // voxels
  for (const auto& entry : regions) {
    for (const Contour& contour : entry.second.contours) {
      Vec3 low = contour.points.front(), high = low;
      for (const Vec3& p : contour.points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
      max_spread = max_spread.cwiseMax(high - low);
    }
  }
  Eigen::Index axis = 2;
  for (const Eigen::Index other : {Eigen::Index{1}, Eigen::Index{0}}) {
    if (max_spread[other] < max_spread[axis]) axis = other;
  }
  const double spread_mm = max_spread[axis] * ct.spacing_mm[axis];
  if (!(spread_mm <= 0.1 + 0.05 * ct.spacing_mm[axis])) {
    fail("expected contours in planes of the CT's slices, found them to lean by ", spread_mm,
         " mm (of another CT?): ", file.string());
  }
  return axis;
}

/// The planes that one region's contours lie in, sorted: where, in voxels across the slices, and which contours.
struct Plane {
  double at = 0.0;
  std::vector<const Contour*> contours;
};

/// How far apart heights (sorted) may be that are one plane's, voxels: rounding, against the distance that planes have.
double same_plane(const std::vector<double>& heights) {
  constexpr double kExact = 0.05, kRounded = 0.25;
  std::vector<double> gaps;
  for (std::size_t n = 1; n < heights.size(); ++n) {
    if (heights[n] - heights[n - 1] > kExact) gaps.push_back(heights[n] - heights[n - 1]);
  }
  if (gaps.empty()) return kExact;
  // Where each plane is two by rounding, every other gap is one of planes.
  const auto upper = gaps.begin() + static_cast<std::ptrdiff_t>(3 * gaps.size() / 4);
  std::nth_element(gaps.begin(), upper, gaps.end());
  return std::clamp(kRounded * *upper, kExact, kRounded);
}

std::vector<Plane> planes_of(const Region& region, Eigen::Index axis) {
  std::vector<std::pair<double, const Contour*>> sorted;
  for (const Contour& contour : region.contours) {
    double sum = 0.0;
    for (const Vec3& p : contour.points) sum += p[axis];
    sorted.emplace_back(sum / static_cast<double>(contour.points.size()), &contour);
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<double> heights;
  heights.reserve(sorted.size());
  for (const auto& [at, contour] : sorted) heights.push_back(at);
  const double same = same_plane(heights);
  std::vector<Plane> planes;
  for (const auto& [at, contour] : sorted) {
    if (planes.empty() || at - planes.back().at > same) planes.push_back({at, {}});
    std::vector<const Contour*>& there = planes.back().contours;
    const auto is_copy = [one = contour](const Contour* other) { return other->points == one->points; };
    // Copies count once: two would leave nothing within an odd number of them.
    if (std::none_of(there.begin(), there.end(), is_copy)) there.push_back(contour);
  }
  return planes;
}

/// The distance that most planes have, voxels, at least one slice. Not the smallest: one plane more between others
/// would leave the slices between those empty.
double usual_gap(const std::vector<Plane>& planes) {
  std::vector<double> gaps;
  for (std::size_t n = 1; n < planes.size(); ++n) gaps.push_back(planes[n].at - planes[n - 1].at);
  if (gaps.empty()) return 1.0;
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>((gaps.size() - 1) / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  return std::max(1.0, *middle);
}

/// How far the contours of plane `n` reach towards a slice, voxels: half-way to the next plane; where that is far,
/// since slices between are without bone, or there is none, as far as most reach.
double reach_of(const std::vector<Plane>& planes, std::size_t n, double slice, double usual) {
  double gap = usual;
  if (slice > planes[n].at && n + 1 < planes.size()) gap = planes[n + 1].at - planes[n].at;
  if (slice < planes[n].at && n > 0) gap = planes[n].at - planes[n - 1].at;
  if (gap > 1.5 * usual) gap = usual;
  constexpr double kRounding = 1e-3;
  return 0.5 * std::max(1.0, gap) + kRounding;
}

/// Calls `put` with the pixels (a, b) whose centres lie within an odd number of the contours.
void fill(const std::vector<const Contour*>& contours, Eigen::Index axis_a, Eigen::Index axis_b, int size_a, int size_b,
          const std::function<void(int, int)>& put) {
  std::vector<std::vector<double>> crossings(static_cast<std::size_t>(size_b));
  for (const Contour* contour : contours) {
    const Vec3* before = &contour->points.back();
    for (const Vec3& point : contour->points) {
      // From the lower end, so that both sides of a channel to a hole cross at the same place, rounding and all: a
      // centre on it would lie between them else, and outside.
      const bool is_up = (*before)[axis_b] < point[axis_b];
      const Vec3& low = is_up ? *before : point;
      const Vec3& high = is_up ? point : *before;
      // An end on a row's line counts for the side above, so that each crossing counts once.
      const int first = static_cast<int>(std::ceil(std::clamp(low[axis_b], 0.0, static_cast<double>(size_b))));
      for (int b = first; b < size_b && b < high[axis_b]; ++b) {
        const double t = (b - low[axis_b]) / (high[axis_b] - low[axis_b]);
        crossings[static_cast<std::size_t>(b)].push_back(low[axis_a] + t * (high[axis_a] - low[axis_a]));
      }
      before = &point;
    }
  }
  for (int b = 0; b < size_b; ++b) {
    std::vector<double>& row = crossings[static_cast<std::size_t>(b)];
    std::sort(row.begin(), row.end());
    for (std::size_t n = 0; n + 1 < row.size(); n += 2) {
      const double max_a = static_cast<double>(size_a);
      const int first = static_cast<int>(std::ceil(std::clamp(row[n], 0.0, max_a)));
      const int end = static_cast<int>(std::ceil(std::clamp(row[n + 1], 0.0, max_a)));
      for (int a = first; a < end; ++a) put(a, b);
    }
  }
}

}  // namespace

LabelFile read_dicom_contours(const fs::path& file, const GridGeometry& ct, std::optional<long long> only,
                              const std::function<void(const LabelFile&)>& begin, const TakeLabels& take) {
  Regions regions = read_regions(file);
  // ROI numbers are any: where they fit into a byte they are labels, else their order is.
  const bool fit = std::all_of(regions.begin(), regions.end(),
                               [](const auto& entry) { return entry.first >= 1 && entry.first <= 255; });
  LabelFile labels;
  labels.size = ct.size;
  labels.index_to_patient = ct.index_to_patient_matrix();
  labels.origin_mm = ct.origin_mm;
  labels.numbers_are_ranks = true;
  std::map<long long, const Region*> by_label;
  long long rank = 0;
  for (auto& [number, region] : regions) {
    const long long label = fit ? number : ++rank;
    if (label > 65535) fail("expected at most 65535 regions of interest, found more in ", file.string());
    const std::string name = name_of_segment(region.segment, file);
    if (std::optional<std::string> doubt = doubt_of_segment(region.segment))
      labels.warnings.push_back(*std::move(doubt));
    keep_closed(region, level_in_name(name).has_value(), file);
    for (Contour& contour : region.contours) {
      for (Vec3& p : contour.points) p = ct.to_index(p);
    }
    labels.names[label] = name;
    by_label[label] = &region;
  }
  const Eigen::Index axis = flat_axis(regions, ct, file);
  const Eigen::Index axis_a = axis == 0 ? 1 : 0, axis_b = axis == 2 ? 1 : 2;
  const auto size_of = [&](Eigen::Index n) { return ct.size[static_cast<std::size_t>(n)]; };
  LabelFile head = labels;
  head.names.clear();
  if (begin) begin(head);
  LabelPainter painter(ct.voxel_count(), labels.names);
  for (const auto& entry : by_label) {
    const auto label = static_cast<std::uint16_t>(entry.first);
    if (only && *only != entry.first) continue;
    const std::vector<Plane> planes = planes_of(*entry.second, axis);
    if (planes.empty()) continue;
    const double usual = usual_gap(planes);
    std::size_t nearest = 0;
    for (int slice = 0; slice < size_of(axis); ++slice) {
      const auto distance = [&](std::size_t n) { return std::abs(planes[n].at - slice); };
      while (nearest + 1 < planes.size() && distance(nearest + 1) < distance(nearest)) ++nearest;
      if (!(distance(nearest) <= reach_of(planes, nearest, slice, usual))) continue;
      fill(planes[nearest].contours, axis_a, axis_b, size_of(axis_a), size_of(axis_b), [&](int a, int b) {
        std::array<int, 3> p{};
        p[static_cast<std::size_t>(axis)] = slice;
        p[static_cast<std::size_t>(axis_a)] = a;
        p[static_cast<std::size_t>(axis_b)] = b;
        painter.put(ct.offset(p[0], p[1], p[2]), label);
      });
    }
  }
  painter.check_shared(file);
  painter.give_to(take);
  return labels;
}

}  // namespace spinaltap::detail

#include "core/ct/detail/dicom_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>

#include "core/base/error.h"
#include "core/base/geometry.h"
#include "core/base/text_writer.h"
#include "core/ct/detail/dicom_slice.h"
#include "core/ct/detail/dicom_values.h"

namespace spinaltap {
namespace {

struct PartingAttribute {
  const char* name;
  std::string (*of)(const DicomHeader&);
};

/// "120", "120.0" and "120.00" are one voltage.
std::string number_text(const std::string& text) {
  const std::vector<double> values = parse_decimal_string(text);
  return values.size() == 1 && std::isfinite(values.front()) ? to_decimal_string(values.front()) : text;
}

constexpr PartingAttribute kFrameOfReference{"FrameOfReferenceUID",
                                             [](const DicomHeader& h) { return h.frame_of_reference; }};
const std::array<PartingAttribute, 4> kOfPicture{
    {{"ConvolutionKernel", [](const DicomHeader& h) { return h.kernel; }},
     {"KVP", [](const DicomHeader& h) { return number_text(h.kvp); }},
     {"ImageType", [](const DicomHeader& h) { return h.image_type; }},
     {"ContrastBolusAgent", [](const DicomHeader& h) { return h.contrast; }}}};
const std::array<PartingAttribute, 4> kOfTime{
    {{"temporal position", [](const DicomHeader& h) { return number_text(h.temporal_position); }},
     {"cardiac phase", [](const DicomHeader& h) { return number_text(h.cardiac_phase); }},
     {"AcquisitionNumber", [](const DicomHeader& h) { return number_text(h.acquisition_number); }},
     {"AcquisitionTime", [](const DicomHeader& h) { return h.acquisition_time; }}}};

using Groups = std::map<std::string, std::vector<std::size_t>>;

Groups groups_by(const std::vector<DicomHeader>& headers, const PartingAttribute& attribute) {
  Groups groups;
  for (std::size_t n = 0; n < headers.size(); ++n) groups[attribute.of(headers[n])].push_back(n);
  return groups;
}

/// Values that are there.
std::size_t count_of_values(const Groups& groups) { return groups.size() - groups.count(""); }

bool are_all_of_two(const Groups& groups) {
  return std::all_of(groups.begin(), groups.end(), [](const auto& group) { return group.second.size() >= 2; });
}

std::vector<DicomPart> split(DicomPart part, const Groups& groups, const char* name) {
  std::vector<DicomPart> parts;
  for (const auto& [value, members] : groups) {
    DicomPart& made = parts.emplace_back();
    for (const std::size_t n : members) made.headers.push_back(std::move(part.headers[n]));
    made.told_apart_by = part.told_apart_by + (part.told_apart_by.empty() ? "" : ", ") + name;
    made.notes = part.notes;
    made.warnings = part.warnings;
  }
  return parts;
}

std::string place_text(const DicomHeader& header) {
  if (header.position_mm.size() != 3) return "without a place";
  TextWriter text;
  text << "at " << header.position_mm[0] << ", " << header.position_mm[1] << ", " << header.position_mm[2] << " mm";
  return text.str();
}

// --- copies

/// All that makes a picture what it is, but for its pixels and its names.
bool is_same_but_pixels(const DicomHeader& a, const DicomHeader& b) {
  const auto geometry = [](const DicomHeader& h) {
    return std::tie(h.columns, h.rows, h.position_mm, h.orientation, h.pixel_spacing_mm, h.rescale_slope,
                    h.rescale_intercept, h.rescale_type, h.padding, h.padding_limit);
  };
  const auto attributes = [](const DicomHeader& h) {
    return std::tie(h.frame_of_reference, h.image_type, h.kernel, h.kvp, h.contrast, h.acquisition_number,
                    h.acquisition_time, h.temporal_position, h.cardiac_phase, h.frame);
  };
  return geometry(a) == geometry(b) && attributes(a) == attributes(b);
}

bool has_same_pixels(const DicomHeader& a, const DicomHeader& b) {
  const auto values = [](const DicomHeader& header) {
    check_dicom_slice(header, true);
    std::vector<std::int16_t> hu(static_cast<std::size_t>(header.columns) * static_cast<std::size_t>(header.rows));
    decode_dicom_slice(header, hu, true);
    return hu;
  };
  return values(a) == values(b);
}

void drop_copies(DicomPart& part) {
  std::map<std::tuple<std::string, int>, std::size_t> by_uid;
  std::map<std::vector<double>, std::vector<std::size_t>> by_place;
  std::vector<DicomHeader> kept;
  const std::size_t all = part.headers.size();
  for (DicomHeader& header : part.headers) {
    bool is_copy = false;
    if (!header.instance_uid.empty()) {
      const auto [found, is_new] = by_uid.try_emplace({header.instance_uid, header.frame}, kept.size());
      if (!is_new) {
        const DicomHeader& other = kept[found->second];
        is_copy = is_same_but_pixels(other, header) && has_same_pixels(other, header);
        if (!is_copy) {
          fail("expected one picture of each SOPInstanceUID, found two that differ, ", path_of(other), " and ",
               path_of(header), " (one was changed after it was copied: take one of them away)");
        }
      }
    }
    if (!is_copy && header.position_mm.size() == 3) {
      std::vector<std::size_t>& there = by_place[header.position_mm];
      is_copy = std::any_of(there.begin(), there.end(), [&](std::size_t n) {
        return is_same_but_pixels(kept[n], header) && has_same_pixels(kept[n], header);
      });
      if (!is_copy) there.push_back(kept.size());
    }
    if (!is_copy) kept.push_back(std::move(header));
  }
  part.headers = std::move(kept);
  if (part.headers.size() < all) {
    part.notes.push_back(
        joined(all - part.headers.size(), " of ", all, " slices are copies of others: each counts once"));
  }
}

// --- frames, kernels, voltages

std::vector<DicomPart> part_by_frame(DicomPart part) {
  const Groups groups = groups_by(part.headers, kFrameOfReference);
  const std::size_t values = count_of_values(groups), slices = part.headers.size();
  if (values < 2) return {std::move(part)};
  constexpr std::size_t kMost = 8;  // no series is of so many scans
  const bool says_nothing = (slices > 2 && values == slices) || values > kMost;
  if (says_nothing) {
    part.notes.push_back(
        joined(values, " FrameOfReferenceUIDs in ", slices, " slices, as anonymizers write them: taken for one frame"));
    return {std::move(part)};
  }
  return split(std::move(part), groups, kFrameOfReference.name);
}

std::vector<DicomPart> part_by_picture(DicomPart part, const PartingAttribute& attribute) {
  const Groups groups = groups_by(part.headers, attribute);
  const std::size_t values = count_of_values(groups), slices = part.headers.size();
  if (values < 2 || (slices > 2 && 2 * values > slices)) return {std::move(part)};
  const auto of_two = static_cast<std::size_t>(
      std::count_if(groups.begin(), groups.end(), [](const auto& group) { return group.second.size() >= 2; }));
  if (of_two >= 2 || slices == 2) return split(std::move(part), groups, attribute.name);
  for (const auto& [value, members] : groups) {
    if (members.size() > 1) continue;
    part.warnings.push_back(joined(attribute.name, " of one slice is not that of the ", slices - 1, " others: the one ",
                                   place_text(part.headers[members.front()]), " may be of another picture"));
  }
  return {std::move(part)};
}

// --- time

/// Numbers of slices in the order of their places along the normal; empty where they state none.
std::vector<std::size_t> order_along(const std::vector<DicomHeader>& headers, std::vector<double>& along_mm) {
  const std::vector<double>& o = headers.front().orientation;
  if (o.size() != 6) return {};
  const Vec3 normal = Vec3(o[0], o[1], o[2]).cross(Vec3(o[3], o[4], o[5]));
  std::vector<std::size_t> order;
  for (std::size_t n = 0; n < headers.size(); ++n) {
    const std::vector<double>& p = headers[n].position_mm;
    if (p.size() != 3) return {};
    along_mm.push_back(normal.dot(Vec3(p[0], p[1], p[2])));
    if (!std::isfinite(along_mm.back())) return {};
    order.push_back(n);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return along_mm[a] < along_mm[b]; });
  return order;
}

constexpr double kOnePlaceMm = 1e-3;

bool coincide(const std::vector<std::size_t>& members, const std::vector<double>& along_mm) {
  std::vector<double> places;
  places.reserve(members.size());
  for (const std::size_t n : members) places.push_back(along_mm[n]);
  std::sort(places.begin(), places.end());
  for (std::size_t n = 1; n < places.size(); ++n) {
    if (places[n] - places[n - 1] < kOnePlaceMm) return true;
  }
  return false;
}

/// Whether the groups take turns along the stack, more often than blocks one after the other would.
bool take_turns(const Groups& groups, const std::vector<std::size_t>& order) {
  std::vector<std::size_t> group_of(order.size());
  std::size_t number = 0;
  for (const auto& [value, members] : groups) {
    for (const std::size_t n : members) group_of[n] = number;
    ++number;
  }
  std::size_t changes = 0;
  for (std::size_t n = 1; n < order.size(); ++n) changes += group_of[order[n]] != group_of[order[n - 1]] ? 1U : 0U;
  return changes > groups.size() - 1;
}

/// "20260101140352.457000" or "140352.457" as seconds; nothing where it is no time.
std::optional<double> seconds_of(const std::string& time) {
  const std::size_t digits = std::min(time.find_first_not_of("0123456789"), time.size());
  if (digits < 6) return std::nullopt;
  const auto number = [&](std::size_t at, std::size_t count) {
    double value = 0.0;
    for (std::size_t n = at; n < at + count; ++n) value = 10.0 * value + (time[n] - '0');
    return value;
  };
  const std::size_t clock = digits >= 14 ? 8 : 0;
  const double days = clock == 8 ? number(0, 4) * 372.0 + number(4, 2) * 31.0 + number(6, 2) : 0.0;
  double seconds = days * 86400.0 + number(clock, 2) * 3600.0 + number(clock + 2, 2) * 60.0 + number(clock + 4, 2);
  double place = 0.1;
  if (digits < time.size() && time[digits] == '.') {
    for (std::size_t n = digits + 1; n < time.size() && time[n] >= '0' && time[n] <= '9'; ++n, place *= 0.1) {
      seconds += place * (time[n] - '0');
    }
  }
  return seconds;
}

/// Slices that were taken with less than 20 s in between.
Groups runs_in_time(const std::vector<DicomHeader>& headers) {
  std::vector<std::pair<double, std::size_t>> times;
  for (std::size_t n = 0; n < headers.size(); ++n) {
    const std::optional<double> seconds = seconds_of(headers[n].acquisition_time);
    if (!seconds) return {};
    times.emplace_back(*seconds, n);
  }
  std::sort(times.begin(), times.end());
  constexpr double kPauseS = 20.0;
  Groups runs;
  int run = 0;
  for (std::size_t n = 0; n < times.size(); ++n) {
    if (n > 0 && times[n].first - times[n - 1].first > kPauseS) ++run;
    runs[joined(1000 + run)].push_back(times[n].second);
  }
  for (auto& [name, members] : runs) std::sort(members.begin(), members.end());
  return runs;
}

std::vector<DicomPart> part_by_time(DicomPart part) {
  std::vector<double> along_mm;
  const std::vector<std::size_t> order = order_along(part.headers, along_mm);
  if (order.size() < 4) return {std::move(part)};
  const bool has_doubles = coincide(order, along_mm);
  const auto parts_them = [&](const Groups& groups) {
    if (groups.size() < 2 || !are_all_of_two(groups)) return false;
    if (!has_doubles) return take_turns(groups, order);
    return std::none_of(groups.begin(), groups.end(),
                        [&](const auto& group) { return coincide(group.second, along_mm); });
  };
  for (const PartingAttribute& attribute : kOfTime) {
    const Groups groups = groups_by(part.headers, attribute);
    if (count_of_values(groups) >= 2 && parts_them(groups)) return split(std::move(part), groups, attribute.name);
  }
  const Groups runs = runs_in_time(part.headers);
  if (parts_them(runs)) return split(std::move(part), runs, "AcquisitionTime");
  return {std::move(part)};
}

template <class Step>
std::vector<DicomPart> each_by(std::vector<DicomPart> parts, const Step& step) {
  std::vector<DicomPart> all;
  for (DicomPart& part : parts) {
    for (DicomPart& made : step(std::move(part))) all.push_back(std::move(made));
  }
  return all;
}

}  // namespace

std::vector<DicomPart> part_into_acquisitions(std::vector<DicomHeader> headers) {
  DicomPart whole;
  whole.headers = std::move(headers);
  drop_copies(whole);
  std::vector<DicomPart> parts = part_by_frame(std::move(whole));
  for (const PartingAttribute& attribute : kOfPicture) {
    parts = each_by(std::move(parts), [&](DicomPart part) { return part_by_picture(std::move(part), attribute); });
  }
  return each_by(std::move(parts), part_by_time);
}

}  // namespace spinaltap

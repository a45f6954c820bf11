#include "core/ct/label_volume.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <set>

#include "core/base/error.h"
#include "core/ct/detail/label_file.h"
#include "core/ct/detail/label_names.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLabels = 256;

/// A label map on its own grid.
struct LabelsOfFile {
  detail::LabelFile head;
  std::vector<std::uint8_t> labels;
};

LabelsOfFile read_all(const fs::path& file, const GridGeometry& ct_geometry) {
  constexpr double kRounding = 1e-3;  // of maps that were stored as floats
  LabelsOfFile read;
  read.head = detail::read_label_file(
      file, ct_geometry, {}, [&](const detail::LabelFile& head) { read.labels.reserve(head.voxel_count()); },
      [&](std::span<const double> values) {
        for (const double value : values) {
          const double label = std::round(value);
          if (!(label >= 0.0 && label < static_cast<double>(kLabels) && std::abs(value - label) <= kRounding)) {
            fail("expected labels that are whole numbers from 0 to ", kLabels - 1, ", found ", value, " in ",
                 file.string());
          }
          read.labels.push_back(static_cast<std::uint8_t>(label));
        }
      });
  return read;
}

/// Where along the patient the middle of each label lies, z of LPS, mm.
std::map<int, double> heights_mm(const LabelsOfFile& read) {
  std::array<double, kLabels> sum_mm{};
  std::array<double, kLabels> count{};
  std::size_t at = 0;
  for (int k = 0; k < read.head.size[2]; ++k) {
    for (int j = 0; j < read.head.size[1]; ++j) {
      for (int i = 0; i < read.head.size[0]; ++i) {
        const std::uint8_t label = read.labels[at++];
        if (label == 0) continue;
        sum_mm[label] += read.head.index_to_patient.row(2).dot(Vec3(i, j, k));
        count[label] += 1.0;
      }
    }
  }
  std::map<int, double> heights;
  for (std::size_t label = 1; label < kLabels; ++label) {
    if (count[label] > 0.0) heights[static_cast<int>(label)] = sum_mm[label] / count[label];
  }
  return heights;
}

bool has_level(const std::map<int, LabelName>& names) {
  return std::any_of(names.begin(), names.end(), [](const auto& entry) { return entry.second.level != Level::kNone; });
}

std::set<int> numbers_of(const std::map<int, double>& heights) {
  std::set<int> numbers;
  for (const auto& entry : heights) numbers.insert(entry.first);
  return numbers;
}

/// "22 is L3 in VerSe or L1 in TotalSegmentator 1", by a number that they do not agree on.
std::string meanings_of(const std::map<int, double>& heights, const std::vector<LabelConvention>& conventions) {
  std::string first;
  for (const auto& entry : heights) {
    std::string text;
    std::set<Level> levels;
    for (const LabelConvention convention : conventions) {
      const Level level = detail::level_of_number(convention, entry.first);
      levels.insert(level);
      const std::string name = level == Level::kNone ? "no vertebra" : level_name(level);
      text += (text.empty() ? std::to_string(entry.first) + " is " : " or ") + name + " in " +
              detail::convention_name(convention);
    }
    if (levels.size() > 1) return text;
    if (first.empty() && !levels.contains(Level::kNone)) first = text;
  }
  return first;
}

std::map<int, LabelName> names_automatically(const LabelsOfFile& read, const fs::path& file) {
  const std::map<int, double> heights = heights_mm(read);
  const std::set<int> present = numbers_of(heights);
  std::map<int, LabelName> names = detail::levels_by_names(present, read.head.names);
  if (has_level(names) || read.head.numbers_are_ranks) return names;
  const std::vector<LabelConvention> possible = detail::possible_conventions(heights);
  if (possible.empty()) return names;
  const std::optional<LabelConvention> sure = detail::sure_convention(heights);
  if (sure) return detail::levels_by_numbers(*sure, present, read.head.names);
  fail("expected a label map that names its vertebrae, found numbers that do not tell: ",
       meanings_of(heights, possible), "; say which convention is meant: ", file.string());
}

std::map<int, LabelName> names_of(const LabelsOfFile& read, LabelConvention convention, const fs::path& file) {
  if (convention == LabelConvention::automatic) return names_automatically(read, file);
  const std::set<int> present = numbers_of(heights_mm(read));
  if (convention != LabelConvention::names && convention != LabelConvention::any_names) {
    return detail::levels_by_numbers(convention, present, read.head.names);
  }
  std::map<int, LabelName> names = detail::levels_by_names(present, read.head.names);
  if (convention == LabelConvention::names && !has_level(names))
    fail("expected a label map that names vertebrae, found no such name in ", file.string());
  return names;
}

void check_each_level_once(const std::map<int, LabelName>& names, const fs::path& file) {
  std::map<Level, int> seen;
  for (const auto& [number, label] : names) {
    if (label.level == Level::kNone) continue;
    const auto [at, is_new] = seen.emplace(label.level, number);
    if (!is_new) {
      fail("expected one label a vertebra, found that ", at->second, " and ", number, " are both ",
           level_name(label.level), " in ", file.string());
    }
  }
}

std::string list_of_levels(const LabelVolume& volume) {
  std::string text;
  for (const Level level : levels_of(volume)) text += (text.empty() ? "" : ", ") + level_name(level);
  return text.empty() ? "none" : text;
}

}  // namespace

LabelVolume read_label_volume(const fs::path& file, const GridGeometry& ct_geometry, LabelConvention convention) {
  check_geometry(ct_geometry, "CT");
  const LabelsOfFile read = read_all(file, ct_geometry);
  const std::map<int, LabelName> names = names_of(read, convention, file);
  check_each_level_once(names, file);

  LabelVolume volume{ct_geometry, std::vector<std::uint8_t>(ct_geometry.voxel_count(), 0), {}};
  std::array<std::atomic<bool>, kLabels> found{};
  detail::for_each_nearest(read.head, ct_geometry, [&](std::size_t at, std::size_t at_file) {
    const std::uint8_t label = read.labels[at_file];
    if (label == 0) return;
    volume.labels[at] = label;
    // Looked at first: a store in each voxel would have the threads wait for each other.
    if (!found[label].load(std::memory_order_relaxed)) found[label].store(true, std::memory_order_relaxed);
  });
  for (const auto& [number, label] : names) {
    if (found[static_cast<std::size_t>(number)]) volume.names[number] = label;
  }
  if (volume.names.empty()) {
    fail(names.empty() ? "expected a label map with labels, found none in "
                       : "expected labels within the CT, found them only outside: ",
         file.string());
  }
  return volume;
}

std::optional<int> label_of(const LabelVolume& volume, Level level) {
  if (level == Level::kNone) return std::nullopt;
  const auto found = std::find_if(volume.names.begin(), volume.names.end(),
                                  [level](const auto& entry) { return entry.second.level == level; });
  if (found == volume.names.end()) return std::nullopt;
  return found->first;
}

std::vector<Level> levels_of(const LabelVolume& volume) {
  std::vector<Level> levels;
  for (const auto& entry : volume.names) {
    if (entry.second.level != Level::kNone) levels.push_back(entry.second.level);
  }
  std::sort(levels.begin(), levels.end(), [](Level a, Level b) { return level_rank(a) < level_rank(b); });
  return levels;
}

BoneMask mask_of(const LabelVolume& volume, int label) {
  BoneMask mask{volume.geometry, std::vector<std::uint8_t>(volume.labels.size(), 0)};
  bool found = false;
  for (std::size_t v = 0; v < volume.labels.size(); ++v) {
    if (label == 0 || volume.labels[v] != label) continue;
    mask.inside[v] = 1;
    found = true;
  }
  if (found) return mask;
  std::set<long long> labels;
  for (const auto& entry : volume.names) labels.insert(entry.first);
  fail("no label ", label, " in the label map; there are: ", detail::list_for_people(labels));
}

BoneMask mask_of(const LabelVolume& volume, Level level) {
  const std::optional<int> label = label_of(volume, level);
  if (!label) fail("no ", level_name(level), " in the label map; there are: ", list_of_levels(volume));
  return mask_of(volume, *label);
}

}  // namespace spinaltap

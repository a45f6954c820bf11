#include "core/ct/label_volume.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <set>

#include "core/base/error.h"
#include "core/ct/detail/label_conventions.h"
#include "core/ct/detail/label_file.h"
#include "core/ct/detail/label_meaning.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLabels = 256;

/// A label map on its own grid.
struct LabelsOfFile {
  detail::LabelFile head;
  std::vector<std::uint8_t> labels;
};

LabelsOfFile read_all(const fs::path& file, const GridGeometry& ct_geometry, const LabelReadOptions& options) {
  detail::LabelFileOptions of_file{.affine = options.affine};
  if (options.wanted != 0) of_file.only = options.wanted;
  LabelsOfFile read;
  read.head = detail::read_label_file(
      file, ct_geometry, of_file, [&](const detail::LabelFile& head) { read.labels.reserve(head.voxel_count()); },
      [&](std::span<const double> values) {
        for (const double value : values) {
          const std::optional<long long> label = detail::label_in(value);
          const bool is_label = label && *label >= 0 && *label < static_cast<long long>(kLabels);
          if (!is_label && options.wanted == 0) {
            fail("expected labels that are whole numbers from 0 to ", kLabels - 1, ", found ", value, " in ",
                 file.string());
          }
          read.labels.push_back(is_label ? static_cast<std::uint8_t>(*label) : std::uint8_t{0});
        }
      });
  return read;
}

std::map<int, detail::LabelShape> shapes_of(const LabelsOfFile& read) {
  struct Sums {
    Vec3 index = Vec3::Zero();
    double count = 0.0;
    Box3 box_mm;  ///< of the voxels' middles, but for the origin
    bool is_cut = false;
  };
  std::array<Sums, kLabels> of_label;
  const std::array<int, 3>& size = read.head.size;
  std::size_t at = 0;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        const std::uint8_t label = read.labels[at++];
        if (label == 0) continue;
        const Vec3 index(i, j, k);
        Sums& sums = of_label[label];
        sums.index += index;
        sums.count += 1.0;
        sums.box_mm.extend(read.head.index_to_patient * index);
        sums.is_cut =
            sums.is_cut || i == 0 || j == 0 || k == 0 || i == size[0] - 1 || j == size[1] - 1 || k == size[2] - 1;
      }
    }
  }
  std::map<int, detail::LabelShape> shapes;
  const Vec3 step_mm = read.head.index_to_patient.cwiseAbs().rowwise().sum();
  const double voxel_mm3 = std::abs(read.head.index_to_patient.determinant());
  for (std::size_t label = 1; label < kLabels; ++label) {
    const Sums& sums = of_label[label];
    if (!(sums.count > 0.0)) continue;
    shapes[static_cast<int>(label)] = {read.head.origin_mm + read.head.index_to_patient * (sums.index / sums.count),
                                       sums.box_mm.sizes() + step_mm, sums.count * voxel_mm3, sums.is_cut};
  }
  return shapes;
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

LabelVolume read_label_volume(const fs::path& file, const GridGeometry& ct_geometry, const LabelReadOptions& options) {
  check_geometry(ct_geometry, "CT");
  const LabelsOfFile read = read_all(file, ct_geometry, options);
  LabelReadOptions meant = options;
  if (read.head.numbers_are_ranks && meant.convention == LabelConvention::automatic) {
    meant.convention = LabelConvention::any_names;
  }
  const detail::LabelMeaning meaning = detail::meaning_of(shapes_of(read), read.head.names, meant, file.string());
  const std::map<int, LabelName>& names = meaning.names;
  check_each_level_once(names, file);

  LabelVolume volume{
      ct_geometry, std::vector<std::uint8_t>(ct_geometry.voxel_count(), 0), {}, meaning.source, read.head.warnings};
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

const std::map<std::string, LabelConvention>& label_conventions() {
  static const std::map<std::string, LabelConvention> kWords = [] {
    std::map<std::string, LabelConvention> words{
        {"automatic", LabelConvention::automatic}, {"names", LabelConvention::names}, {"none", LabelConvention::none}};
    for (const detail::LabelNumbering& one : detail::label_numberings()) {
      words[std::string(one.keyword)] = one.convention;
    }
    return words;
  }();
  return kWords;
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

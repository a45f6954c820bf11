// altered_levels TABLE.csv CT...: segments each CT as it is, and as other scanners would have it: in thicker slices, by
// sharper kernels with more noise, of lighter bone, of another size. Writes a line for each level that is whole and not
// suspect in the CT as it is, with how right it is in the altered one, in trunk_levels' columns.
//
// Compiled with optimisation: whole CTs are resampled.

#include <cstdio>
#include <exception>
#include <functional>

#include "core/base/error.h"
#include "core/ct/read_ct.h"
#include "tests/support/altered_ct.h"
#include "tests/support/mask_overlap.h"
#include "tests/support/spine_scores.h"
#include "tests/trunks/level_table.h"

namespace spinaltap::test {
namespace {

struct AlteredScan {
  std::string name;
  std::function<CtVolume(const CtVolume&)> made_of;
  double by = 1.0;  ///< it is as many times as large
};

std::vector<AlteredScan> alterations() {
  std::vector<AlteredScan> all;
  for (const auto& [pixel, step, width] : std::vector<std::array<double, 3>>{{0.6, 1.2, 1.2},
                                                                             {0.6, 1.6, 1.6},
                                                                             {0.75, 2.2, 2.2},
                                                                             {0.7, 2.5, 4.0},
                                                                             {0.9, 3.0, 3.0},
                                                                             {0.85, 4.0, 4.0},
                                                                             {0.8, 5.0, 5.0}}) {
    all.push_back({joined(pixel, " x ", step, " mm"),
                   [p = pixel, s = step, w = width](const CtVolume& ct) { return resliced(ct, p, s, w); }});
  }
  all.push_back({"sharper and noise", [](const CtVolume& ct) { return sharpened(ct, 1.0, 80.0, 11); }});
  all.push_back({"much sharper", [](const CtVolume& ct) { return sharpened(ct, 2.2, 40.0, 12); }});
  all.push_back({"noise", [](const CtVolume& ct) { return sharpened(ct, 0.0, 60.0, 13); }});
  all.push_back({"light bone", [](const CtVolume& ct) { return with_light_bone(ct, 0.7); }});
  for (const double by : {0.8, 1.1}) {
    all.push_back({joined("times ", by), [by](const CtVolume& ct) { return scaled_by(ct, by); }, by});
  }
  return all;
}

/// A label on the grid of a CT that is `by` times as large: of the nearest voxels.
BoneMask mask_on(const GridGeometry& geometry, const LabelVolume& own, int label, double by) {
  BoneMask mask{geometry, {}};
  mask.inside.reserve(geometry.voxel_count());
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const Vec3 place = own.geometry.to_index(geometry.to_patient(Vec3(i, j, k)) / by);
        const Eigen::Vector3i at = place.array().round().cast<int>();
        const bool is_there = own.geometry.contains(at.x(), at.y(), at.z()) &&
                              own.labels[own.geometry.offset(at.x(), at.y(), at.z())] == label;
        mask.inside.push_back(is_there ? 1 : 0);
      }
    }
  }
  return mask;
}

void examine(const std::string& file, LevelTable& table) {
  const CtVolume ct = read_ct(file);
  const SpineSegmentation own = segment_spine(ct);
  for (const AlteredScan& alteration : alterations()) {
    const CtVolume altered = alteration.made_of(ct);
    SpineSegmentation found;
    std::string said;
    try {
      found = segment_spine(altered);
    } catch (const Error& error) {
      said = error.what();
    }
    std::vector<bool> used(found.levels.size(), false);
    int wrong = 0, all = 0;
    for (const LevelReport& level : own.levels) {
      if (level.is_cut || level.is_suspect()) continue;
      LevelRow row;
      row.ct = std::filesystem::path(file).parent_path().filename().string() + " " + alteration.name;
      row.slice_mm = altered.geometry.spacing_mm.maxCoeff();
      row.level = level.name;
      row.centre_mm = 7.0;
      row.is_told = !said.empty() || !found.gaps.empty();
      if (const auto nearest = nearest_level(found, used, alteration.by * level.body_centre_mm, row.centre_mm)) {
        used[nearest->index] = true;
        row.found = &found.levels[nearest->index];
        row.centre_mm = nearest->away_mm;
        row.dice = dice(mask_on(altered.geometry, own.labels, level.label, alteration.by),
                        mask_of(found.labels, row.found->label));
        row.is_told = row.found->is_suspect();
        row.figures = doubt_figures(altered, found, nearest->index);
      }
      row.is_wrong = !(row.dice >= right_dice_at(row.slice_mm));
      ++all;
      wrong += row.is_wrong ? 1 : 0;
      table.add(row);
    }
    std::printf("%s %s: %d levels, %d wrong or missed\n", file.c_str(), alteration.name.c_str(), all, wrong);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace spinaltap::test

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: altered_levels TABLE.csv CT...\n");
    return 2;
  }
  try {
    spinaltap::test::LevelTable table(argv[1]);
    for (int n = 2; n < argc; ++n) spinaltap::test::examine(argv[n], table);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "altered_levels: %s\n", error.what());
    return 1;
  }
}

#include "core/segment/segment_spine.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

#include "core/base/error.h"
#include "core/segment/binned_ct.h"

namespace spinaltap {
namespace {

using Mask = std::vector<std::uint8_t>;

/// Calls `visit(voxel of a, voxel of b)` for the blocks that two cuts share.
template <class Visit>
void for_shared(const LevelCut& a, const LevelCut& b, const Visit& visit) {
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  std::array<int, 3> shift{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    shift[axis] = (a.box.low[axis] - b.box.low[axis]) / a.bins[axis];  // from a's blocks to b's
    low[axis] = std::max(0, -shift[axis]);
    high[axis] = std::min(a.geometry().size[axis], b.geometry().size[axis] - shift[axis]);
  }
  for (int k = low[2]; k < high[2]; ++k) {
    for (int j = low[1]; j < high[1]; ++j) {
      for (int i = low[0]; i < high[0]; ++i) {
        visit(a.geometry().offset(i, j, k), b.geometry().offset(i + shift[0], j + shift[1], k + shift[2]));
      }
    }
  }
}

/// The voxels that are likelier `cut`'s than a neighbour's or no vertebra's at all.
Mask own_voxels(const LevelCut& cut, const std::vector<const LevelCut*>& neighbours) {
  std::vector<float> most(cut.probability.size(), 0.0F);  // of the neighbours
  std::vector<float> sum(cut.probability);                // of all
  for (const LevelCut* other : neighbours) {
    for_shared(cut, *other, [&](std::size_t here, std::size_t there) {
      const float p = other->probability[there];
      most[here] = std::max(most[here], p);
      sum[here] += p;
    });
  }
  Mask mine(most.size());
  for (std::size_t v = 0; v < mine.size(); ++v) {
    const float p = cut.probability[v];
    mine[v] = p > most[v] && p > 1.0F - sum[v] && p > 0.0F ? 1 : 0;
  }
  return mine;
}

SegmentedLevel finished(const CtVolume& ct, const SpineBodies& spine, std::size_t index, const LevelCut& cut,
                        const std::vector<const LevelCut*>& neighbours) {
  SegmentedLevel level;
  Mask mine = own_voxels(cut, neighbours);
  level.index = index;
  level.body = spine.bodies[index].cylinder;
  level.cut_below = spine.chain[index].lower.is_cut;
  level.cut_above = spine.chain[index].upper.is_cut;
  level.cut_area_mm2 = cut_area_mm2(cut, mine);
  FinishedLevel done = finish_level(cut, std::move(mine), ct, spine.levels);
  level.box = done.box;
  level.inside = std::move(done.inside);
  level.parts_dropped = done.parts_dropped;
  return level;
}

}  // namespace

SpineBodies find_spine_bodies(const CtVolume& ct, std::optional<double> threshold_hu,
                              const std::optional<Vec3>& near_mm, const Progress& progress) {
  SpineBodies spine;
  spine.levels = choose_bone_levels(ct, threshold_hu);
  spine.canal = find_spinal_canal(ct, spine.levels, near_mm, progress);
  if (spine.canal.points_mm.empty()) return spine;
  progress.report("finding the vertebral bodies", 0.0);
  const FloatGrid hu = hu_around_canal(ct, spine.canal);
  constexpr double kBlurMm = 0.9;
  const FloatGrid smooth = gaussian_blur(hu, kBlurMm);
  const WallLevels walls{spine.levels.low_hu};
  const SpineColumn column = fit_spine_column(smooth, spine.canal, walls);
  progress.report("finding the vertebral bodies", 0.4);
  spine.chain = find_body_chain(blurred_as_asked(hu, spine.levels, ct), column, walls);
  progress.report("finding the vertebral bodies", 0.6);
  std::vector<std::optional<VertebralBody>> bodies(spine.chain.size());
  tbb::parallel_for(std::size_t{0}, bodies.size(),
                    [&](std::size_t n) { bodies[n] = find_vertebral_body(smooth, spine.chain[n], walls); });
  for (std::optional<VertebralBody>& body : bodies) spine.bodies.push_back(std::move(*body));
  progress.report("finding the vertebral bodies", 1.0);
  return spine;
}

std::vector<SegmentedLevel> segment_levels(const CtVolume& ct, const SpineBodies& spine, std::size_t first,
                                           std::size_t last, const Progress& progress) {
  if (first > last || last >= spine.bodies.size()) {
    fail("segmentation: expected levels of a row of ", spine.bodies.size(), ", found ", first, " to ", last);
  }
  // Direct neighbours are cut too, for what is theirs.
  const std::size_t low = first > 0 ? first - 1 : 0;
  const std::size_t high = std::min(last + 1, spine.bodies.size() - 1);
  std::vector<std::unique_ptr<LevelCut>> cuts(spine.bodies.size());
  std::vector<SegmentedLevel> found(last - first + 1);
  ProgressCounter counter(progress, "parting the vertebrae", high - low + 1);
  // Two at a time: a cut takes a hundred megabytes, and is not needed longer than its neighbours.
  constexpr std::size_t kAtOnce = 2;
  std::size_t next = first;
  for (std::size_t begin = low; begin <= high; begin += kAtOnce) {
    const std::size_t end = std::min(begin + kAtOnce, high + 1);
    tbb::parallel_for(begin, end, [&](std::size_t n) {
      cuts[n] = std::make_unique<LevelCut>(cut_level(ct, spine.levels, {spine.bodies, spine.canal, n}));
      counter.add();
    });
    for (; next <= last && (next + 1 < end || end == high + 1); ++next) {
      std::vector<const LevelCut*> neighbours;
      if (next > low) neighbours.push_back(cuts[next - 1].get());
      if (next < high) neighbours.push_back(cuts[next + 1].get());
      found[next - first] = finished(ct, spine, next, *cuts[next], neighbours);
      if (next > low) cuts[next - 1].reset();
    }
  }
  return found;
}

}  // namespace spinaltap

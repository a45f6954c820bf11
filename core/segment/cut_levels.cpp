#include "core/segment/cut_levels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

#include "core/base/error.h"
#include "core/segment/detail/binned_ct.h"
#include "core/segment/detail/connected_parts.h"

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
    high[axis] = std::min(a.geometry.size[axis], b.geometry.size[axis] - shift[axis]);
  }
  for (int k = low[2]; k < high[2]; ++k) {
    for (int j = low[1]; j < high[1]; ++j) {
      for (int i = low[0]; i < high[0]; ++i) {
        visit(a.geometry.offset(i, j, k), b.geometry.offset(i + shift[0], j + shift[1], k + shift[2]));
      }
    }
  }
}

/// The voxels that are likelier `cut`'s than a neighbour's or no vertebra's at all.
Mask own_voxels(const LevelCut& cut, const std::vector<const LevelCut*>& neighbours) {
  std::vector<float> max(cut.probability.size(), 0.0F);  // of the neighbours
  std::vector<float> sum(cut.probability);               // of all
  for (const LevelCut* other : neighbours) {
    for_shared(cut, *other, [&](std::size_t here, std::size_t there) {
      const float p = other->probability[there];
      max[here] = std::max(max[here], p);
      sum[here] += p;
    });
  }
  Mask mine(max.size());
  for (std::size_t v = 0; v < mine.size(); ++v) {
    const float p = cut.probability[v];
    mine[v] = p > max[v] && p > 1.0F - sum[v] && p > 0.0F ? 1 : 0;
  }
  return mine;
}

/// Ribs: bone that hangs together with what is one for `sure`, and is no vertebra's.
void find_ribs_of(const LevelCut& cut, const Mask& vertebrae, const Mask& sure, const GridGeometry& ct,
                  const BodyCylinder& body, CutVertebra& level) {
  Mask rest(cut.bone.size());
  for (std::size_t v = 0; v < rest.size(); ++v) {
    rest[v] = cut.bone[v] != 0 && vertebrae[v] == 0 && cut.markers[v] != WalkerVoxel::kOutside ? 1 : 0;
  }
  // Spurs and discs between the bodies are nobody's; ribs end beside the column.
  for_voxels_by_body(rest, cut.geometry, body, [&](std::size_t voxel, const Vec3& p) {
    if (std::abs(p.x()) < body.half_mm.x()) rest[voxel] = 0;
  });
  const Mask ribs = parts_that_touch(rest, sure, cut.geometry);
  level.ribs_box = cut.box;
  const std::array<int, 3>& bins = cut.bins;
  level.ribs.reserve(crop_geometry(ct, cut.box).voxel_count());
  for (int k = cut.box.low[2]; k <= cut.box.high[2]; ++k) {
    for (int j = cut.box.low[1]; j <= cut.box.high[1]; ++j) {
      for (int i = cut.box.low[0]; i <= cut.box.high[0]; ++i) {
        level.ribs.push_back(ribs[cut.geometry.offset((i - cut.box.low[0]) / bins[0], (j - cut.box.low[1]) / bins[1],
                                                      (k - cut.box.low[2]) / bins[2])]);
      }
    }
  }
  // Between the transverse process and where the ribs of the level above have long gone sideways.
  constexpr double kNearMm = 32.0;
  const double voxel_mm3 = cut.geometry.spacing_mm.prod();
  for_voxels_by_body(ribs, cut.geometry, body, [&](std::size_t, const Vec3& p) {
    if (std::abs(p.x()) > kNearMm || std::abs(p.z()) > 1.3 * body.half_mm.z() || p.y() < -0.3 * body.half_mm.y()) {
      return;
    }
    (p.x() > 0.0 ? level.left_rib_mm3 : level.right_rib_mm3) += voxel_mm3;
  });
}

CutVertebra finished(const CtVolume& ct, const SpineBodies& spine, std::size_t index, const LevelCut& cut,
                     const std::vector<const LevelCut*>& neighbours) {
  CutVertebra level;
  const BodyInRow row{spine.bodies, spine.canal, index, spine.has_sacrum};
  Mask mine = own_voxels(cut, neighbours);
  Mask ribs = cut.ribs;
  double sharpness = 1.0;
  for (const double side : {1.0, -1.0}) {
    if (row.is_cervical()) break;  // the bars around a foramen are as thin as a rib's joint
    const SideBone bone = find_side_bone(cut, mine, row.body().cylinder, side);
    if (bone.voxels.empty()) sharpness = std::min(sharpness, bone.sharpness);
    for (const std::size_t voxel : bone.voxels) {
      mine[voxel] = 0;
      ribs[voxel] = 1;
    }
  }
  level.index = index;
  level.cut_area_mm2 = cut_area_mm2(cut, mine);
  Mask others(mine.size(), 0);
  for (const LevelCut* other : neighbours) {
    for_shared(cut, *other, [&](std::size_t here, std::size_t there) {
      if (mine[here] == 0 && other->probability[there] > cut.probability[here]) others[here] = 1;
    });
  }
  Mask vertebrae(mine);
  for (std::size_t v = 0; v < vertebrae.size(); ++v)
    if (others[v] != 0) vertebrae[v] = 1;
  find_ribs_of(cut, vertebrae, ribs, ct.geometry, row.body().cylinder, level);
  FinishedLevel done = finish_level(cut, mine, others, ct, spine.levels);
  level.figures = measure_level(cut, {.finished = done.blocks, .given = mine, .others = others}, row);
  level.figures.side_sharpness = sharpness;
  level.box = done.box;
  level.inside = std::move(done.inside);
  level.parts_dropped = done.parts_dropped;
  return level;
}

}  // namespace

void cut_levels(const CtVolume& ct, const SpineBodies& spine, std::size_t first, std::size_t last,
                const std::vector<MarkedVoxels>& marks, const std::function<void(CutVertebra&&)>& visit,
                const Progress& progress) {
  if (first > last || last >= spine.bodies.size()) {
    fail("segmentation: expected levels of a row of ", spine.bodies.size(), ", found ", first, " to ", last);
  }
  // Direct neighbours are cut too, for what is theirs.
  const std::size_t low = first > 0 ? first - 1 : 0;
  const std::size_t high = std::min(last + 1, spine.bodies.size() - 1);
  std::vector<std::unique_ptr<LevelCut>> cuts(spine.bodies.size());
  ProgressCounter counter(progress, "parting the vertebrae", high - low + 1);
  // A cut takes a hundred megabytes until its level is done, and little until its neighbours are: two at a time, and
  // only one for a single level, which should need no more memory than it must.
  const std::size_t at_once = first == last ? 1 : 2;
  std::size_t next = first;
  for (std::size_t begin = low; begin <= high; begin += at_once) {
    const std::size_t end = std::min(begin + at_once, high + 1);
    tbb::parallel_for(begin, end, [&](std::size_t n) {
      cuts[n] = std::make_unique<LevelCut>(
          cut_level(ct, spine.levels, {spine.bodies, spine.canal, n, spine.has_sacrum}, marks));
      if (n < first || n > last) cuts[n]->keep_probability_only();
      counter.add();
    });
    for (; next <= last && (next + 1 < end || end == high + 1); ++next) {
      std::vector<const LevelCut*> neighbours;
      if (next > low) neighbours.push_back(cuts[next - 1].get());
      if (next < high) neighbours.push_back(cuts[next + 1].get());
      visit(finished(ct, spine, next, *cuts[next], neighbours));
      cuts[next]->keep_probability_only();
      if (next > low) cuts[next - 1].reset();
    }
  }
}

}  // namespace spinaltap

#include "core/segment/spinal_canal.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/base/error.h"
#include "core/segment/detail/binned_ct.h"
#include "core/segment/detail/grey_closing.h"
#include "core/segment/detail/median.h"

namespace spinaltap {
namespace {

constexpr double kBlockMm = SpinalCanal::kStepMm;
constexpr const char* kStage = "finding the spinal canal";

/// The CT in blocks of about kBlockMm, axes along the patient's.
struct Blocks {
  GridGeometry geometry;
  std::vector<float> mean, brightest;
  std::vector<std::uint8_t> is_bone;  ///< holds a voxel over the low level, and is near to one over the sure level
};

Box3 box_of(const GridGeometry& geometry) {
  Box3 box;
  for (int corner = 0; corner < 8; ++corner) {
    const auto end = [&](std::size_t axis) { return (corner >> axis) & 1 ? geometry.size[axis] - 0.5 : -0.5; };
    box.extend(geometry.to_patient(Vec3(end(0), end(1), end(2))));
  }
  return box;
}

/// How many samples a voxel gives along each axis, itself and others on the way to the next one, so that no block of
/// kBlockMm stays empty between voxels that stand far apart.
std::array<int, 3> samples_of(const GridGeometry& geometry) {
  constexpr double kMaxStepMm = 0.65 * kBlockMm;
  std::array<int, 3> samples{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double spacing_mm = geometry.spacing_mm[static_cast<Eigen::Index>(axis)];
    samples[axis] = std::max(1, static_cast<int>(std::ceil(spacing_mm / kMaxStepMm)));
  }
  return samples;
}

/// The CT in steps of about 1 mm, blurred as its noise asks for, some layers of it at a time: as floats the whole would
/// take more memory than all else.
class LayeredCt {
 public:
  LayeredCt(const CtVolume& ct, const BoneLevels& levels)
      : ct_(ct), levels_(levels), bins_(bins_for(ct.geometry, 1.0)), geometry_(whole_geometry()) {
    const double blur_mm = levels.blur_voxels * ct.geometry.smallest_spacing_mm();
    margin_ = static_cast<int>(std::ceil(kBlurReach * blur_mm / geometry_.spacing_mm.z())) + 1;
  }

  const GridGeometry& geometry() const { return geometry_; }

  /// Calls `visit(layer, grid, its place in the grid)` for each layer from below; the next one is in the grid too.
  template <class Visit>
  void for_layers(const Visit& visit) const {
    constexpr int kAtOnce = 48;
    const int layers = geometry_.size[2];
    for (int begin = 0; begin < layers; begin += kAtOnce) {
      const int end = std::min(begin + kAtOnce, layers);
      const int low = std::max(0, begin - margin_);
      const int high = std::min(layers, end + margin_) - 1;
      const VoxelBox box{{0, 0, low * bins_[2]},
                         {ct_.geometry.size[0] - 1, ct_.geometry.size[1] - 1,
                          std::min((high + 1) * bins_[2], ct_.geometry.size[2]) - 1}};
      const FloatGrid grid = blurred_as_asked(bin_hu(ct_, box, bins_), levels_, ct_);
      for (int layer = begin; layer < end; ++layer) visit(layer, grid, layer - low);
    }
  }

 private:
  GridGeometry whole_geometry() const {
    const auto& size = ct_.geometry.size;
    return binned_geometry(ct_.geometry, {{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}}, bins_);
  }

  const CtVolume& ct_;
  const BoneLevels& levels_;
  std::array<int, 3> bins_;
  GridGeometry geometry_;
  int margin_ = 1;
};

/// Each voxel of the CT, in steps of about 1 mm and blurred as its noise asks for, goes to the block that it lies in;
/// of larger voxels samples between them too.
Blocks blocks_of(const CtVolume& ct, const BoneLevels& levels) {
  const LayeredCt layered(ct, levels);
  const GridGeometry& fine = layered.geometry();
  const Box3 box = box_of(fine);
  Blocks blocks;
  blocks.geometry.spacing_mm = Vec3::Constant(kBlockMm);
  blocks.geometry.origin_mm = box.min() + Vec3::Constant(0.5 * kBlockMm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length_mm = box.sizes()[static_cast<Eigen::Index>(axis)];
    blocks.geometry.size[axis] = std::max(1, static_cast<int>(std::floor(length_mm / kBlockMm)));
  }
  const GridGeometry& geometry = blocks.geometry;
  constexpr float kNothing = std::numeric_limits<float>::lowest();
  blocks.brightest.assign(geometry.voxel_count(), kNothing);
  std::vector<float> sum(geometry.voxel_count(), 0.0F);
  std::vector<int> count(geometry.voxel_count(), 0);
  const Mat3 step = fine.index_to_patient_matrix() / kBlockMm;
  const Vec3 first = geometry.to_index(fine.origin_mm);
  const auto put = [&](const Vec3& at, float value) {
    const int x = static_cast<int>(std::floor(at.x()));
    const int y = static_cast<int>(std::floor(at.y()));
    const int z = static_cast<int>(std::floor(at.z()));
    if (!geometry.contains(x, y, z)) return;
    const std::size_t block = geometry.offset(x, y, z);
    blocks.brightest[block] = std::max(blocks.brightest[block], value);
    sum[block] += value;
    ++count[block];
  };
  // One thread: blocks are shared by slices of a CT of any orientation, and sums must not depend on an order.
  const std::array<int, 3> samples = samples_of(fine);
  layered.for_layers([&](int k, const FloatGrid& grid, int layer) {
    std::size_t voxel = grid.geometry.offset(0, 0, layer);
    for (int j = 0; j < fine.size[1]; ++j) {
      Vec3 at = first + step.col(1) * j + step.col(2) * k + Vec3::Constant(0.5);
      for (int i = 0; i < fine.size[0]; ++i, ++voxel, at += step.col(0)) {
        put(at, grid.values[voxel]);
        for (int s = 1; s < samples[0] * samples[1] * samples[2]; ++s) {
          const int row = s / samples[0], slice = row / samples[1];
          const Vec3 part(static_cast<double>(s % samples[0]) / samples[0],
                          static_cast<double>(row % samples[1]) / samples[1], static_cast<double>(slice) / samples[2]);
          put(at + step * part, static_cast<float>(sample_clamped(grid, Vec3(i, j, layer) + part)));
        }
      }
    }
  });
  blocks.mean.resize(sum.size());
  constexpr float kAirHu = -1000.0F;
  for (std::size_t b = 0; b < sum.size(); ++b) {
    blocks.mean[b] = count[b] > 0 ? sum[b] / static_cast<float>(count[b]) : kAirHu;
  }
  // Vessels with contrast are over the low level too, and nowhere near the sure one.
  constexpr double kNearSureMm = 2.0 * kBlockMm;
  std::vector<float> near_sure = close_gaps({geometry, blocks.brightest}, kNearSureMm).peak;
  blocks.is_bone.resize(near_sure.size());
  for (std::size_t b = 0; b < near_sure.size(); ++b) {
    blocks.is_bone[b] =
        blocks.brightest[b] >= static_cast<float>(levels.low_hu) && near_sure[b] >= static_cast<float>(levels.sure_hu);
  }
  return blocks;
}

constexpr int kRayDirections = 16;
constexpr int kRayBlocks = 8;  // blocks: 20 mm

/// Steps in blocks, to the left and to the back, along one direction.
using Ray = std::array<std::array<int, 2>, kRayBlocks>;

std::array<Ray, kRayDirections> rays_around() {
  std::array<Ray, kRayDirections> rays{};
  for (int n = 0; n < kRayDirections; ++n) {
    const double turn = 2.0 * std::numbers::pi * n / kRayDirections;
    const double x = std::sin(turn), y = -std::cos(turn);  // the first one to the front
    for (int r = 1; r <= kRayBlocks; ++r) {
      rays[static_cast<std::size_t>(n)][static_cast<std::size_t>(r - 1)] = {static_cast<int>(std::lround(x * r)),
                                                                            static_cast<int>(std::lround(y * r))};
    }
  }
  return rays;
}

class CanalScore {
 public:
  explicit CanalScore(const Blocks& blocks) : blocks_(blocks) {
    const GridGeometry& geometry = blocks.geometry;
    columns_ = geometry.size[0] + 2 * kRayBlocks;
    rows_ = geometry.size[1] + 2 * kRayBlocks;
    is_bone_.assign(place(-kRayBlocks, -kRayBlocks, geometry.size[2]), 0);
    density_.reserve(blocks.mean.size());
    for (int k = 0; k < geometry.size[2]; ++k) {
      for (int j = 0; j < geometry.size[1]; ++j) {
        for (int i = 0; i < geometry.size[0]; ++i) {
          const std::size_t block = geometry.offset(i, j, k);
          is_bone_[place(i, j, k)] = blocks.is_bone[block];
          // Cortex and metal count as bone and no more, lung no less than fat.
          density_.push_back(std::clamp((static_cast<double>(blocks.mean[block]) - 40.0) / 160.0, -0.6, 1.2));
        }
      }
    }
    const std::array<Ray, kRayDirections> rays = rays_around();
    for (std::size_t n = 0; n < rays.size(); ++n) {
      for (std::size_t r = 0; r < rays[n].size(); ++r) steps_[n][r] = rays[n][r][1] * columns_ + rays[n][r][0];
    }
  }

  /// How far the middle between opposite walls lies from a block, in blocks, to the left and to the back; nothing where
  /// one of the walls is not seen.
  std::array<std::optional<double>, 2> off_middle(int i, int j, int k) const {
    const auto between = [&](std::size_t a, std::size_t b) -> std::optional<double> {
      const int low = first_bone(place(i, j, k), a);
      const int high = first_bone(place(i, j, k), b);
      if (low == 0 || high == 0) return std::nullopt;
      return 0.5 * (high - low);
    };
    return {between(kRight, kLeft), between(kFront, kBack)};
  }

  /// How much a block looks like the canal with a body in front: 0, or up to about 2.
  double operator()(int i, int j, int k) const {
    const float here = blocks_.mean[blocks_.geometry.offset(i, j, k)];
    // Fat is in canals too, and air in those of dry bones; cancellous bone, where it is denser, is none.
    if (here > 120.0F) return 0.0;
    std::array<int, kRayDirections> hits{};
    for (std::size_t n = 0; n < hits.size(); ++n) hits[n] = first_bone(place(i, j, k), n);
    double seen = 0.0;
    double across = 0.0;  // pairs of opposite walls, as near as a canal's and not as a body's
    constexpr std::size_t kHalf = kRayDirections / 2;
    for (std::size_t n = 0; n < kHalf; ++n) {
      const int a = hits[n];
      const int b = hits[n + kHalf];
      seen += (a > 0 ? 1.0 : 0.0) + (b > 0 ? 1.0 : 0.0);
      if (a > 0 && b > 0 && a <= kNear && b <= kNear) across += 1.0;
    }
    return 0.5 * seen / kRayDirections + 0.75 * across / static_cast<double>(kHalf) +
           0.75 * body_in_front(i, j, k, hits[kFront]);
  }

 private:
  // Of the directions, which begin at the front and go round by the left.
  static constexpr std::size_t kFront = 0, kLeft = kRayDirections / 4, kBack = kRayDirections / 2,
                               kRight = 3 * kRayDirections / 4;
  static constexpr int kNear = 5;  // 12.5 mm

  /// Of a block in is_bone_, which has kRayBlocks blocks more on the four sides that rays go to.
  std::size_t place(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(rows_) + static_cast<std::size_t>(j + kRayBlocks)) *
               static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(i + kRayBlocks);
  }

  bool is_bone(int i, int j, int k) const {
    return blocks_.geometry.contains(i, j, k) && blocks_.is_bone[blocks_.geometry.offset(i, j, k)] != 0;
  }

  /// Blocks to the first bone along a direction, at least 1; 0 when there is none within reach.
  int first_bone(std::size_t from, std::size_t direction) const {
    for (int r = 1; r <= kRayBlocks; ++r) {
      const std::ptrdiff_t step = steps_[direction][static_cast<std::size_t>(r - 1)];
      if (is_bone_[from + static_cast<std::size_t>(step)] != 0) return r;
    }
    return 0;
  }

  /// 0 to 1: how dense it is for a body's depth in front of the canal's front wall, over a body's width. A vessel with
  /// contrast is as dense, but has no wall in front.
  double body_in_front(int i, int j, int k, int front) const {
    constexpr int kDepth = 8;  // 20 mm
    constexpr int kHalfWidth = 3;
    constexpr int kMinWall = 4, kMaxWall = 18;  // of the body's front wall from its back wall: 10 to 45 mm
    const int wall = front > 0 && front <= kNear ? front : 3;
    bool has_front_wall = false;
    for (int y = j - wall - kMinWall; y >= j - wall - kMaxWall && !has_front_wall; --y) {
      for (int x = i - 1; x <= i + 1; ++x) has_front_wall = has_front_wall || is_bone(x, y, k);
    }
    if (!has_front_wall) return 0.0;
    double sum = 0.0;
    int count = 0;
    for (int y = j - wall; y > j - wall - kDepth; --y) {
      for (int x = i - kHalfWidth; x <= i + kHalfWidth; ++x) {
        ++count;
        if (!blocks_.geometry.contains(x, y, k)) continue;
        sum += density_[blocks_.geometry.offset(x, y, k)];
      }
    }
    return std::clamp(sum / count, 0.0, 1.0);
  }

  const Blocks& blocks_;
  int columns_ = 0, rows_ = 0;  ///< of is_bone_
  std::vector<std::uint8_t> is_bone_;
  std::vector<double> density_;  ///< of each block: 0 of what is as dense as muscle, 1 of cancellous bone
  std::array<std::array<std::ptrdiff_t, kRayBlocks>, kRayDirections> steps_{};  ///< along each direction, in is_bone_
};

/// Mean over a block's neighbours in its slice and those above and below: single lucky places do not make a canal.
std::vector<float> smoothed(const std::vector<float>& score, const GridGeometry& geometry) {
  FloatGrid grid{geometry, score};
  return gaussian_blur(grid, kBlockMm).values;
}

constexpr int kMaxShift = 3;  // blocks from slice to slice
/// What a slice must score for a chain to gain by it.
constexpr double kMinScore = 0.8;
constexpr double kShiftCost = 0.15;

/// The best chain's gain up to each block, coming from slice k - direction, and where it comes from.
struct Chains {
  std::vector<float> gain;
  std::vector<std::int8_t> from_x, from_y;  ///< shift to the block before; kStart where the chain begins
  static constexpr std::int8_t kStart = 100;
};

Chains best_chains(const std::vector<float>& score, const GridGeometry& geometry, int direction) {
  Chains chains;
  chains.gain.resize(score.size());
  chains.from_x.assign(score.size(), Chains::kStart);
  chains.from_y.assign(score.size(), Chains::kStart);
  const int first = direction > 0 ? 0 : geometry.size[2] - 1;
  for (int n = 0, k = first; n < geometry.size[2]; ++n, k += direction) {
    tbb::parallel_for(0, geometry.size[1], [&](int j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const std::size_t here = geometry.offset(i, j, k);
        const double own = static_cast<double>(score[here]) - kMinScore;
        double best = 0.0;
        for (int dy = -kMaxShift; n > 0 && dy <= kMaxShift; ++dy) {
          for (int dx = -kMaxShift; dx <= kMaxShift; ++dx) {
            if (!geometry.contains(i + dx, j + dy, k - direction)) continue;
            const double cost = kShiftCost * (dx * dx + dy * dy);
            const double gain = static_cast<double>(chains.gain[geometry.offset(i + dx, j + dy, k - direction)]) - cost;
            if (gain <= best) continue;
            best = gain;
            chains.from_x[here] = static_cast<std::int8_t>(dx);
            chains.from_y[here] = static_cast<std::int8_t>(dy);
          }
        }
        chains.gain[here] = static_cast<float>(best + own);
      }
    });
  }
  return chains;
}

using Index = std::array<int, 3>;

/// The blocks of the chain from a block on, that one first.
std::vector<Index> follow(const Chains& chains, const GridGeometry& geometry, Index at, int direction) {
  std::vector<Index> way{at};
  for (;;) {
    const std::size_t here = geometry.offset(at[0], at[1], at[2]);
    if (chains.from_x[here] == Chains::kStart) return way;
    at = {at[0] + chains.from_x[here], at[1] + chains.from_y[here], at[2] - direction};
    way.push_back(at);
  }
}

/// Whether a canal at a place may be that of a body which holds `near_mm`.
bool may_be_behind(const Vec3& p_mm, const Vec3& near_mm) {
  const Vec3 way = p_mm - near_mm;
  return std::abs(way.z()) < 2.0 * kBlockMm && way.y() > 4.0 && way.y() < 50.0 && std::abs(way.x()) < 22.0;
}

/// The chain's places moved to the middle between the canal's walls: by what the median of nearby slices says, for in
/// some there is no wall at the sides, and behind there is none between laminae.
std::vector<Vec3> centred(const std::vector<Index>& chain, const CanalScore& score_at) {
  constexpr int kReach = 5;
  std::vector<std::array<std::optional<double>, 2>> off;
  off.reserve(chain.size());
  for (const Index& at : chain) off.push_back(score_at.off_middle(at[0], at[1], at[2]));
  std::vector<Vec3> places;
  const int last = static_cast<int>(chain.size()) - 1;
  for (int n = 0; n <= last; ++n) {
    const Index& here = chain[static_cast<std::size_t>(n)];
    Vec3 place(here[0], here[1], here[2]);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      std::vector<double> middles;
      for (int m = std::max(0, n - kReach); m <= std::min(last, n + kReach); ++m) {
        const std::optional<double>& one = off[static_cast<std::size_t>(m)][axis];
        if (one) middles.push_back(*one);
      }
      if (middles.empty()) continue;
      place[static_cast<Eigen::Index>(axis)] += detail::upper_median(std::move(middles));
    }
    places.push_back(place);
  }
  return places;
}

/// Averages over `reach` points on each side, fewer at the ends: no kinks of whole blocks.
std::vector<Vec3> evened(const std::vector<Vec3>& points, int reach) {
  std::vector<Vec3> even(points.size());
  const int last = static_cast<int>(points.size()) - 1;
  for (int n = 0; n <= last; ++n) {
    const int here = std::min({reach, n, last - n});
    Vec3 sum = Vec3::Zero();
    for (int m = n - here; m <= n + here; ++m) sum += points[static_cast<std::size_t>(m)];
    even[static_cast<std::size_t>(n)] = sum / (2.0 * here + 1.0);
  }
  return even;
}

/// A chain that goes aside by more than 40 degrees over 30 mm, as no spine does, is several: the part with most gain,
/// or that which holds `middle` where a place was asked for.
std::vector<Index> straightest_part(const std::vector<Index>& chain, const std::vector<float>& score,
                                    const GridGeometry& geometry, const CanalSearch& search, const Index& middle) {
  constexpr std::size_t kReach = 12;  // blocks, 30 mm
  constexpr double kMaxAside = 0.84;  // tan 40 degrees
  std::vector<bool> is_steep(chain.size(), false);
  for (std::size_t n = 0; n + kReach < chain.size(); ++n) {
    const double aside = std::abs(chain[n + kReach][0] - chain[n][0]);
    if (aside <= kMaxAside * kReach) continue;
    for (std::size_t m = n + kReach / 4; m <= n + kReach - kReach / 4; ++m) is_steep[m] = true;
  }
  std::vector<Index> best, part;
  double best_gain = -1.0, gain = 0.0;
  const auto end = [&] {
    const bool is_asked = search.near_mm && std::find(part.begin(), part.end(), middle) != part.end();
    if (!part.empty() && (is_asked || gain > best_gain)) {
      best_gain = is_asked ? std::numeric_limits<double>::infinity() : gain;
      best = part;
    }
    part.clear();
    gain = 0.0;
  };
  for (std::size_t n = 0; n < chain.size(); ++n) {
    if (is_steep[n]) {
      end();
      continue;
    }
    part.push_back(chain[n]);
    gain += static_cast<double>(score[geometry.offset(chain[n][0], chain[n][1], chain[n][2])]) - kMinScore;
  }
  end();
  return best;
}

/// No canal goes where another one was found.
void take_out(const SpinalCanal& canal, const GridGeometry& geometry, std::vector<float>& score) {
  constexpr double kNearMm = 12.0;
  const int reach = static_cast<int>(std::ceil(kNearMm / kBlockMm));
  for (const Vec3& p_mm : canal.points_mm) {
    const Eigen::Array3i at = geometry.to_index(p_mm).array().round().cast<int>();
    for (int j = at.y() - reach; j <= at.y() + reach; ++j) {
      for (int i = at.x() - reach; i <= at.x() + reach; ++i) {
        if (geometry.contains(i, j, at.z())) score[geometry.offset(i, j, at.z())] = 0.0F;
      }
    }
  }
}

}  // namespace

struct CanalFinder::Scores {
  Blocks blocks;
  CanalScore score_at;
  std::vector<float> smooth;

  Scores(const CtVolume& ct, const BoneLevels& levels, const Progress& progress)
      : blocks(blocks_of(ct, levels)), score_at(blocks) {
    progress.report(kStage, 0.3);
    const GridGeometry& geometry = blocks.geometry;
    std::vector<float> score(geometry.voxel_count(), 0.0F);
    tbb::parallel_for(0, geometry.size[2], [&](int k) {
      for (int j = 0; j < geometry.size[1]; ++j) {
        for (int i = 0; i < geometry.size[0]; ++i) {
          score[geometry.offset(i, j, k)] = static_cast<float>(score_at(i, j, k));
        }
      }
    });
    smooth = smoothed(score, geometry);
  }
};

CanalFinder::CanalFinder(const CtVolume& ct, const BoneLevels& levels, const Progress& progress) {
  progress.report(kStage, 0.0);
  scores_ = std::make_unique<const Scores>(ct, levels, progress);
}
CanalFinder::~CanalFinder() = default;

SpinalCanal CanalFinder::find(const CanalSearch& search, const Progress& progress) const {
  const GridGeometry& geometry = scores_->blocks.geometry;
  std::vector<float> score = scores_->smooth;
  for (const SpinalCanal& other : search.but_not) take_out(other, geometry, score);
  progress.report(kStage, 0.6);
  const Chains up = best_chains(score, geometry, 1);
  const Chains down = best_chains(score, geometry, -1);
  double best = 0.0;
  Index middle{-1, -1, -1};
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        if (search.near_mm && !may_be_behind(geometry.to_patient(Vec3(i, j, k)), *search.near_mm)) continue;
        const std::size_t here = geometry.offset(i, j, k);
        // The block itself counts in both.
        const double whole = static_cast<double>(up.gain[here]) + static_cast<double>(down.gain[here]) -
                             (static_cast<double>(score[here]) - kMinScore);
        if (whole <= best) continue;
        best = whole;
        middle = {i, j, k};
      }
    }
  }
  SpinalCanal canal;
  if (middle[0] < 0) return canal;
  std::vector<Index> chain = follow(up, geometry, middle, 1);
  std::reverse(chain.begin(), chain.end());
  const std::vector<Index> upper = follow(down, geometry, middle, -1);
  chain.insert(chain.end(), upper.begin() + 1, upper.end());
  constexpr std::size_t kMinBlocks = 4;
  if (chain.size() < kMinBlocks) return canal;
  chain = straightest_part(chain, score, geometry, search, middle);
  if (chain.size() < kMinBlocks) return canal;
  for (const Vec3& place : centred(chain, scores_->score_at)) canal.points_mm.push_back(geometry.to_patient(place));
  for (const Index& at : chain) {
    canal.support.push_back(static_cast<double>(score[geometry.offset(at[0], at[1], at[2])]));
  }
  constexpr int kEvenBlocks = 3;
  canal.points_mm = evened(canal.points_mm, kEvenBlocks);
  progress.report(kStage, 1.0);
  return canal;
}

}  // namespace spinaltap

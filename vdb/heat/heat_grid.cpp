#include "vdb/heat/heat_grid.h"

#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"
#include "vdb/heat/detail/heat_block.h"

namespace spinaltap {

using detail::flow_within;
using detail::for_layer;
using detail::heat_index_in;
using detail::heat_origin_of;
using detail::heat_place_in;
using detail::HeatBlock;
using detail::HeatIndex;
using detail::HeatVoxel;
using detail::kHeatSide;
using detail::kHeatStride;
using detail::kHeatVoxels;

namespace {

constexpr double kSeenRiseK = 3e-3;   ///< at a block's border from which the next block is there
constexpr double kBehindWall = 0.25;  ///< voxels from the wall to where its heat goes in
constexpr double kStable = 0.5;       ///< of the longest stable step: at more, checkerboards die out slowly

}  // namespace

struct HeatGrid::State {
  const HeatMedium& medium;
  HeatGridOptions options;
  std::vector<std::unique_ptr<HeatBlock>> blocks = {};  ///< in the order in which they came
  std::map<HeatIndex, HeatBlock*> by_origin = {};       ///< null: all air
  std::size_t turn = 0;
  double time_s = 0.0;
  HeatBalance sums = {};
  // Of the last bit.
  Vec3 hole_tip_mm = Vec3::Zero();
  Vec3 hole_axis = Vec3::UnitZ();
  double hole_radius_mm = 0.0;

  double voxel_mm3() const { return options.voxel_mm * options.voxel_mm * options.voxel_mm; }
  Vec3 to_index(const Vec3& p_mm) const {
    return options.axes.transpose() * (p_mm - options.origin_mm) / options.voxel_mm;
  }
  Vec3 to_patient(const HeatIndex& voxel) const {
    return options.origin_mm + options.voxel_mm * (options.axes * Vec3(voxel[0], voxel[1], voxel[2]));
  }
  Vec3 place_mm(const HeatBlock& block, std::size_t n) const {
    const HeatIndex in = heat_place_in(n);
    return to_patient({block.origin[0] + in[0], block.origin[1] + in[1], block.origin[2] + in[2]});
  }

  const HeatBlock* find(const HeatIndex& voxel) const {
    const auto found = by_origin.find(heat_origin_of(voxel));
    return found == by_origin.end() ? nullptr : found->second;
  }
  HeatBlock* block_at(const HeatIndex& voxel);
  void share_out(const Vec3& at_mm, double heat_j, bool is_on_wall);
  void link(HeatBlock& block);
  void renew_faces(HeatBlock& block) const;
  void step(HeatBlock& block, double dt_s) const;
  void grow();
  /// From a voxel's centre through its outer half to the water, W/(mm² K).
  double wall_transfer(const HeatBlock& block, std::size_t n) const {
    const double half_mm2_k_w = 0.5 * options.voxel_mm / static_cast<double>(block.conductivity[n]);
    return options.wall_transfer_w_mm2_k / (1.0 + options.wall_transfer_w_mm2_k * half_mm2_k_w);
  }
  void give(HeatBlock& block, std::size_t n, double heat_j) const {
    block.rise_k[turn][n] += heat_j * block.per_capacity[n] / voxel_mm3();
    block.max_k[n] = std::max(block.max_k[n], static_cast<float>(block.rise_k[turn][n]));
    // At once, or the first step would go to one side only.
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t layer = n / kHeatStride[axis] % kHeatSide;
      if (layer == 0) block.is_seen[2 * axis] = true;
      if (layer == kHeatSide - 1) block.is_seen[2 * axis + 1] = true;
    }
  }
};

HeatBlock* HeatGrid::State::block_at(const HeatIndex& voxel) {
  const HeatIndex origin = heat_origin_of(voxel);
  const auto [place, is_new] = by_origin.try_emplace(origin, nullptr);
  if (!is_new) return place->second;
  auto block = std::make_unique<HeatBlock>();
  block->origin = origin;
  std::array<Vec3, kHeatVoxels> points;
  std::array<ThermalTissue, kHeatVoxels> tissues;
  for (std::size_t n = 0; n < kHeatVoxels; ++n) points[n] = place_mm(*block, n);
  medium.tissues(points, tissues);
  bool has_bone = false;
  for (std::size_t n = 0; n < kHeatVoxels; ++n) {
    if (!(tissues[n].conductivity_w_mm_k > 0.0)) continue;
    has_bone = true;
    block->voxel[n] = HeatVoxel::bone;
    block->conductivity[n] = static_cast<float>(tissues[n].conductivity_w_mm_k);
    block->per_capacity[n] = 1.0 / tissues[n].capacity_j_mm3_k;
  }
  if (!has_bone) return nullptr;
  place->second = block.get();
  blocks.push_back(std::move(block));
  link(*blocks.back());
  return place->second;
}

void HeatGrid::State::share_out(const Vec3& at_mm, double heat_j, bool is_on_wall) {
  const Vec3 at = to_index(at_mm);
  const HeatIndex low{static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())),
                      static_cast<int>(std::floor(at.z()))};
  std::array<std::pair<HeatBlock*, std::size_t>, 8> places;
  std::array<double, 8> weights{};
  double sum = 0.0;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    HeatIndex voxel = low;
    double weight = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool is_up = ((corner >> axis) & 1U) != 0;
      const double share = at[static_cast<Eigen::Index>(axis)] - low[axis];
      if (is_up) ++voxel[axis];
      weight *= is_up ? share : 1.0 - share;
    }
    places[corner] = {block_at(voxel), heat_index_in(voxel)};
    const auto& [block, n] = places[corner];
    if (block != nullptr && block->voxel[n] == HeatVoxel::bone) weights[corner] = weight;
    sum += weights[corner];
  }
  if (!(sum > 1e-9)) {
    sums.missed_j += heat_j;
    return;
  }
  sums.given_j += heat_j;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    if (!(weights[corner] > 0.0)) continue;
    const auto& [block, n] = places[corner];
    const double part_j = heat_j * weights[corner] / sum;
    // What lies on the wall is half a voxel before the places that stand for it: some goes to the water at once.
    const double transfer = options.wall_transfer_w_mm2_k;
    const double stays = is_on_wall && transfer > 0.0 ? wall_transfer(*block, n) / transfer : 1.0;
    give(*block, n, stays * part_j);
    sums.water_j += (1.0 - stays) * part_j;
  }
}

void HeatGrid::State::link(HeatBlock& block) {
  for (std::size_t side = 0; side < 6; ++side) {
    HeatIndex origin = block.origin;
    origin[side / 2] += side % 2 == 0 ? -kHeatSide : kHeatSide;
    const auto found = by_origin.find(origin);
    if (found == by_origin.end() || found->second == nullptr) continue;
    HeatBlock& other = *found->second;
    block.near[side] = &other;
    other.near[side ^ 1U] = &block;
    other.is_stale = true;
  }
}

void HeatGrid::State::renew_faces(HeatBlock& block) const {
  block.is_stale = false;
  block.max_rate_per_s = 0.0;
  const double per_square_mm2 = 1.0 / (options.voxel_mm * options.voxel_mm);
  for (std::size_t n = 0; n < kHeatVoxels; ++n) {
    block.wall[n] = 0.0F;
    for (std::size_t axis = 0; axis < 3; ++axis) block.face[axis][n] = 0.0F;
    if (block.voxel[n] != HeatVoxel::bone) continue;
    // A wall's steps have more face than the wall: each face counts as far as it looks along the wall's normal.
    const Vec3 from_tip = place_mm(block, n) - hole_tip_mm;
    const Vec3 across = from_tip - from_tip.dot(hole_axis) * hole_axis;
    const Vec3 normal = options.axes.transpose() * across.normalized();
    const HeatIndex in = heat_place_in(n);
    double sum = 0.0;
    for (std::size_t side = 0; side < 6; ++side) {
      const std::size_t axis = side / 2;
      const bool is_up = side % 2 == 1;
      const bool is_inside = is_up ? in[axis] < kHeatSide - 1 : in[axis] > 0;
      const HeatBlock* other = is_inside ? &block : block.near[side];
      if (other == nullptr) continue;
      const std::size_t across_block = (kHeatSide - 1) * kHeatStride[axis];
      const std::size_t m = is_inside ? (is_up ? n + kHeatStride[axis] : n - kHeatStride[axis])
                                      : (is_up ? n - across_block : n + across_block);
      if (other->voxel[m] == HeatVoxel::drilled) {
        block.wall[n] += static_cast<float>(std::abs(normal[static_cast<Eigen::Index>(axis)]));
      } else if (other->voxel[m] == HeatVoxel::bone) {
        const float one = block.conductivity[n], two = other->conductivity[m];
        const float both = 2.0F * one * two / (one + two);
        if (is_up) block.face[axis][n] = both;
        sum += static_cast<double>(both);
      }
    }
    sum += static_cast<double>(block.wall[n]) * wall_transfer(block, n) * options.voxel_mm;
    block.max_rate_per_s = std::max(block.max_rate_per_s, sum * block.per_capacity[n] * per_square_mm2);
  }
}

void HeatGrid::State::step(HeatBlock& block, double dt_s) const {
  const std::array<double, kHeatVoxels>& now = block.rise_k[turn];
  std::array<double, kHeatVoxels>& next = block.rise_k[1 - turn];
  const double per_square_mm2 = 1.0 / (options.voxel_mm * options.voxel_mm);

  // What flows in through the faces, W/mm³ without the square of the voxel.
  std::array<double, kHeatVoxels> flow{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    flow_within(block.face[axis], now, kHeatStride[axis], flow);
    const std::size_t across_block = (kHeatSide - 1) * kHeatStride[axis];
    if (const HeatBlock* after = block.near[2 * axis + 1]; after != nullptr) {
      for_layer(axis, kHeatSide - 1, [&](std::size_t n) {
        flow[n] += static_cast<double>(block.face[axis][n]) * (after->rise_k[turn][n - across_block] - now[n]);
      });
    }
    if (const HeatBlock* before = block.near[2 * axis]; before != nullptr) {
      for_layer(axis, 0, [&](std::size_t n) {
        const std::size_t m = n + across_block;
        flow[n] += static_cast<double>(before->face[axis][m]) * (before->rise_k[turn][m] - now[n]);
      });
    }
  }
  std::array<double, kHeatVoxels> to_water_w_mm3{};
  block.water_k_mm3_s = 0.0;
  for (std::size_t n = 0; n < kHeatVoxels; ++n) {
    if (!(block.wall[n] > 0.0F)) continue;
    to_water_w_mm3[n] = static_cast<double>(block.wall[n]) * wall_transfer(block, n) / options.voxel_mm *
                        (now[n] - options.water_rise_k);
    block.water_k_mm3_s += to_water_w_mm3[n] * dt_s;
  }
  // What is no bone has no faces, no capacity and no rise: these loops have no branches, so that compilers make
  // vectors.
  for (std::size_t n = 0; n < kHeatVoxels; ++n) {
    next[n] = now[n] + dt_s * block.per_capacity[n] * (flow[n] * per_square_mm2 - to_water_w_mm3[n]);
  }
  for (std::size_t n = 0; n < kHeatVoxels; ++n) {
    block.max_k[n] = std::max(block.max_k[n], static_cast<float>(next[n]));
  }
  for (std::size_t which = 0; which < 2; ++which) {
    const double hot_k = options.hot_rise_k[which];
    if (std::none_of(next.begin(), next.end(), [&](double rise) { return rise > hot_k; })) continue;
    for (std::size_t n = 0; n < kHeatVoxels; ++n) {
      if (block.voxel[n] == HeatVoxel::bone && next[n] > hot_k) block.hot_s[which][n] += static_cast<float>(dt_s);
    }
  }
  for (std::size_t side = 0; side < 6; ++side) {
    if (block.near[side] != nullptr || block.is_seen[side]) continue;
    for_layer(side / 2, side % 2 == 0 ? 0 : kHeatSide - 1, [&](std::size_t n) {
      if (std::abs(next[n]) > kSeenRiseK) block.is_seen[side] = true;
    });
  }
}

void HeatGrid::State::grow() {
  const std::size_t count = blocks.size();
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t side = 0; side < 6; ++side) {
      if (!blocks[n]->is_seen[side] || blocks[n]->near[side] != nullptr) continue;
      HeatIndex voxel = blocks[n]->origin;
      voxel[side / 2] += side % 2 == 0 ? -kHeatSide : kHeatSide;
      block_at(voxel);
    }
  }
}

HeatGrid::HeatGrid(const HeatMedium& medium, const HeatGridOptions& options)
    : state_(new State{.medium = medium, .options = options}) {
  if (!(options.voxel_mm >= 0.01) || !(options.voxel_mm <= 10.0)) {
    fail("heat: expected voxels of 0.01 to 10 mm, found ", options.voxel_mm);
  }
  if (!options.origin_mm.allFinite() || !((options.axes.transpose() * options.axes - Mat3::Identity()).norm() < 1e-6) ||
      !(options.axes.determinant() > 0.0)) {
    fail("heat: expected a finite origin and axes that are unit, at right angles and right-handed");
  }
  if (!(options.wall_transfer_w_mm2_k >= 0.0) || !std::isfinite(options.wall_transfer_w_mm2_k) ||
      !std::isfinite(options.water_rise_k)) {
    fail("heat: expected a heat transfer of 0 or more and a finite temperature of water, found ",
         options.wall_transfer_w_mm2_k, " W/(mm2 K) and ", options.water_rise_k, " K");
  }
}

HeatGrid::~HeatGrid() = default;
HeatGrid::HeatGrid(HeatGrid&&) noexcept = default;

void HeatGrid::heat_point(const Vec3& at_mm, double heat_j) { state_->share_out(at_mm, heat_j, false); }

void HeatGrid::heat_ring(const Vec3& centre_mm, const Vec3& axis, double radius_mm, double heat_j) {
  const double voxel_mm = state_->options.voxel_mm;
  const double ring_mm = radius_mm + kBehindWall * voxel_mm;
  const Vec3 across = any_perpendicular(axis);
  const Vec3 further = axis.cross(across);
  const int count = std::max(16, static_cast<int>(std::ceil(4.0 * std::numbers::pi * ring_mm / voxel_mm)));
  for (int n = 0; n < count; ++n) {
    const double angle = 2.0 * std::numbers::pi * (n + 0.5) / count;
    const Vec3 at_mm = centre_mm + ring_mm * (std::cos(angle) * across + std::sin(angle) * further);
    state_->share_out(at_mm, heat_j / count, true);
  }
}

void HeatGrid::drill(const BitProfile& bit, const Pose& pose) {
  State& s = *state_;
  s.hole_tip_mm = pose.tip_mm;
  s.hole_axis = pose.axis;
  s.hole_radius_mm = bit.radius_mm();
  Box3 box;
  for (const double back_mm : {0.0, bit.length_mm()}) {
    const Vec3 on_axis = s.to_index(pose.tip_mm - back_mm * pose.axis);
    const Vec3 reach = Vec3::Constant(bit.radius_mm() / s.options.voxel_mm);
    box.extend(on_axis - reach);
    box.extend(on_axis + reach);
  }
  const HeatIndex low =
      heat_origin_of({static_cast<int>(std::floor(box.min().x())), static_cast<int>(std::floor(box.min().y())),
                      static_cast<int>(std::floor(box.min().z()))});
  for (int x = low[0]; x <= box.max().x(); x += kHeatSide) {
    for (int y = low[1]; y <= box.max().y(); y += kHeatSide) {
      for (int z = low[2]; z <= box.max().z(); z += kHeatSide) {
        HeatBlock* block = s.block_at({x, y, z});
        if (block == nullptr) continue;
        bool is_drilled = false;
        for (std::size_t n = 0; n < kHeatVoxels; ++n) {
          if (block->voxel[n] != HeatVoxel::bone) continue;
          const Vec3 from_tip = s.place_mm(*block, n) - pose.tip_mm;
          const double along_mm = from_tip.dot(pose.axis);
          if (!bit.contains(-along_mm, from_tip.squaredNorm() - along_mm * along_mm)) continue;
          s.sums.drilled_j += block->rise_k[s.turn][n] / block->per_capacity[n] * s.voxel_mm3();
          block->voxel[n] = HeatVoxel::drilled;
          block->rise_k[0][n] = block->rise_k[1][n] = 0.0;
          block->max_k[n] = block->hot_s[0][n] = block->hot_s[1][n] = 0.0F;
          is_drilled = true;
        }
        if (!is_drilled) continue;
        block->is_stale = true;
        for (HeatBlock* other : block->near) {
          if (other != nullptr) other->is_stale = true;
        }
      }
    }
  }
}

void HeatGrid::advance(double dt_s) {
  if (!(dt_s > 0.0) || !std::isfinite(dt_s)) fail("heat: expected a time above 0, found ", dt_s, " s");
  State& s = *state_;
  double left_s = dt_s;
  while (left_s > 0.0) {
    s.grow();
    tbb::parallel_for(std::size_t{0}, s.blocks.size(), [&](std::size_t n) {
      if (s.blocks[n]->is_stale) s.renew_faces(*s.blocks[n]);
    });
    double max_rate_per_s = 0.0;
    for (const auto& block : s.blocks) max_rate_per_s = std::max(max_rate_per_s, block->max_rate_per_s);
    const double stable_s = max_rate_per_s > 0.0 ? kStable / max_rate_per_s : left_s;
    const double step_s = left_s / std::ceil(left_s / stable_s - 1e-9);
    tbb::parallel_for(std::size_t{0}, s.blocks.size(), [&](std::size_t n) { s.step(*s.blocks[n], step_s); });
    s.turn = 1 - s.turn;
    s.time_s += step_s;
    for (const auto& block : s.blocks) s.sums.water_j += block->water_k_mm3_s * s.voxel_mm3();
    if (!(step_s < left_s)) break;
    left_s -= step_s;
  }
}

double HeatGrid::time_s() const { return state_->time_s; }

const std::array<double, 2>& HeatGrid::hot_rise_k() const { return state_->options.hot_rise_k; }

HeatBalance HeatGrid::balance() const {
  HeatBalance balance = state_->sums;
  for (const auto& block : state_->blocks) {
    for (std::size_t n = 0; n < kHeatVoxels; ++n) {
      if (block->voxel[n] != HeatVoxel::bone) continue;
      balance.in_bone_j += block->rise_k[state_->turn][n] / block->per_capacity[n] * state_->voxel_mm3();
    }
  }
  return balance;
}

std::size_t HeatGrid::voxels() const { return kHeatVoxels * state_->blocks.size(); }

namespace {

HeatIndex nearest_voxel(const Vec3& at) {
  return {static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
          static_cast<int>(std::lround(at.z()))};
}

}  // namespace

double HeatGrid::rise_k(const Vec3& at_mm) const {
  const HeatIndex voxel = nearest_voxel(state_->to_index(at_mm));
  const HeatBlock* block = state_->find(voxel);
  return block == nullptr ? 0.0 : block->rise_k[state_->turn][heat_index_in(voxel)];
}

double HeatGrid::max_rise_k(const Vec3& at_mm) const {
  const HeatIndex voxel = nearest_voxel(state_->to_index(at_mm));
  const HeatBlock* block = state_->find(voxel);
  return block == nullptr ? 0.0 : static_cast<double>(block->max_k[heat_index_in(voxel)]);
}

double HeatGrid::warmest_k() const {
  double warmest = 0.0;
  for (const auto& block : state_->blocks) {
    for (const double rise : block->rise_k[state_->turn]) warmest = std::max(warmest, rise);
  }
  return warmest;
}

HottestVoxel HeatGrid::hottest(double from_wall_mm) const {
  HottestVoxel hottest;
  const double least_mm = from_wall_mm > 0.0 ? state_->hole_radius_mm + from_wall_mm : 0.0;
  for (const auto& block : state_->blocks) {
    for (std::size_t n = 0; n < kHeatVoxels; ++n) {
      const auto rise = static_cast<double>(block->max_k[n]);
      if (block->voxel[n] != HeatVoxel::bone || !(rise > hottest.rise_k)) continue;
      const Vec3 at_mm = state_->place_mm(*block, n);
      const Vec3 from_tip = at_mm - state_->hole_tip_mm;
      const double along_mm = from_tip.dot(state_->hole_axis);
      if (from_tip.squaredNorm() - along_mm * along_mm < least_mm * least_mm) continue;
      hottest = {rise, at_mm};
    }
  }
  return hottest;
}

double HeatGrid::hot_volume_mm3(std::size_t which, double seconds) const {
  if (which > 1) fail("heat: expected rise 0 or 1, found ", which);
  std::size_t count = 0;
  for (const auto& block : state_->blocks) {
    for (std::size_t n = 0; n < kHeatVoxels; ++n) {
      // Sums of steps: half a thousandth for their rounding.
      if (block->voxel[n] == HeatVoxel::bone && static_cast<double>(block->hot_s[which][n]) >= 0.9995 * seconds &&
          block->hot_s[which][n] > 0.0F) {
        ++count;
      }
    }
  }
  return static_cast<double>(count) * state_->voxel_mm3();
}

HeatVolume HeatGrid::volume() const {
  const State& s = *state_;
  if (s.blocks.empty()) fail("heat: expected some to make a volume of, found none in bone");
  HeatIndex low = s.blocks.front()->origin, high = low;
  for (const auto& block : s.blocks) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], block->origin[axis]);
      high[axis] = std::max(high[axis], block->origin[axis]);
    }
  }
  HeatVolume volume;
  GridGeometry& grid = volume.geometry;
  grid.origin_mm = s.to_patient(low);
  grid.spacing_mm = Vec3::Constant(s.options.voxel_mm);
  grid.directions = s.options.axes;
  for (std::size_t axis = 0; axis < 3; ++axis) grid.size[axis] = high[axis] - low[axis] + kHeatSide;
  check_geometry(grid, "volume of heat");
  volume.max_rise_k.resize(grid.voxel_count());
  for (const auto& block : s.blocks) {
    for (std::size_t n = 0; n < kHeatVoxels; ++n) {
      const HeatIndex in = heat_place_in(n);
      volume.max_rise_k[grid.offset(block->origin[0] - low[0] + in[0], block->origin[1] - low[1] + in[1],
                                    block->origin[2] - low[2] + in[2])] = block->max_k[n];
    }
  }
  return volume;
}

void HeatGrid::write(const std::filesystem::path& path, double first_c) const {
  initialize_openvdb();
  const State& s = *state_;
  // Rows of OpenVDB's matrices are the columns of ours.
  openvdb::Mat4d map = openvdb::Mat4d::identity();
  for (int index_axis = 0; index_axis < 3; ++index_axis) {
    for (int axis = 0; axis < 3; ++axis) map(index_axis, axis) = s.options.voxel_mm * s.options.axes(axis, index_axis);
    map(3, index_axis) = s.options.origin_mm[index_axis];
  }
  const auto make_grid = [&](const char* name, double background, const auto& value_of) {
    auto grid = openvdb::FloatGrid::create(static_cast<float>(background));
    grid->setTransform(openvdb::math::Transform::createLinearTransform(map));
    grid->setName(name);
    for (const auto& [origin, block] : s.by_origin) {
      if (block == nullptr) continue;
      auto* leaf = grid->tree().touchLeaf({origin[0], origin[1], origin[2]});
      for (std::size_t n = 0; n < kHeatVoxels; ++n) {
        if (block->voxel[n] == HeatVoxel::bone) leaf->setValueOn(static_cast<openvdb::Index>(n), value_of(*block, n));
      }
    }
    return grid;
  };
  openvdb::GridCPtrVec grids;
  grids.push_back(make_grid("max_temperature", first_c, [&](const HeatBlock& block, std::size_t n) {
    return static_cast<float>(first_c + static_cast<double>(block.max_k[n]));
  }));
  for (std::size_t which = 0; which < 2; ++which) {
    grids.push_back(make_grid(which == 0 ? "seconds_hot_0" : "seconds_hot_1", 0.0,
                              [&](const HeatBlock& block, std::size_t n) { return block.hot_s[which][n]; }));
  }
  try {
    detail::write_vdb(path, grids);
  } catch (const openvdb::Exception& error) {
    fail("heat: writing ", path.string(), ": ", error.what());
  }
}

}  // namespace spinaltap

#include "vdb/detail/grid_sampler.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace spinaltap::detail {
namespace {

/// The largest whole number that is not above `x`, which must fit. std::floor() is a call without SSE 4.1.
int floor_of(double x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < static_cast<double>(truncated) ? 1 : 0);
}

/// A voxel, counted from the table's first.
using Place = std::array<unsigned, 3>;

Place place_of(const BlockTable& table, int x, int y, int z) {
  return {static_cast<unsigned>(x - table.low[0]), static_cast<unsigned>(y - table.low[1]),
          static_cast<unsigned>(z - table.low[2])};
}

std::size_t block_at(const BlockTable& table, const Place& voxel) {
  return table.offset(voxel[0] / kTableSide, voxel[1] / kTableSide, voxel[2] / kTableSide);
}

/// A cube of values with a side of Size voxels, z fastest.
template <unsigned Size>
using Values = std::array<float, std::size_t{Size} * Size * Size>;

/// The values from voxel `first` on.
template <unsigned Size>
Values<Size> gather(const BlockTable& table, const Place& first) {
  Values<Size> values;
  std::size_t next = 0;
  const Place in_block{first[0] % kTableSide, first[1] % kTableSide, first[2] % kTableSide};
  constexpr unsigned kLast = kTableSide - Size;
  if (in_block[0] <= kLast && in_block[1] <= kLast && in_block[2] <= kLast) {
    const float* const corner =
        table.blocks[block_at(table, first)] + ((in_block[0] * kTableSide + in_block[1]) * kTableSide + in_block[2]);
    for (unsigned i = 0; i < Size; ++i) {
      for (unsigned j = 0; j < Size; ++j) {
        for (unsigned k = 0; k < Size; ++k) values[next++] = corner[(i * kTableSide + j) * kTableSide + k];
      }
    }
    return values;
  }
  // The cube reaches into other blocks. What each axis adds to the places of a value is found once.
  const std::array<std::size_t, 3> block_steps{table.offset(1, 0, 0), table.offset(0, 1, 0), 1};
  constexpr std::array<unsigned, 3> kValueSteps{kTableSide * kTableSide, kTableSide, 1};
  std::array<std::array<std::size_t, Size>, 3> block{};
  std::array<std::array<unsigned, Size>, 3> value{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (unsigned i = 0; i < Size; ++i) {
      const unsigned at = first[axis] + i;
      block[axis][i] = at / kTableSide * block_steps[axis];
      value[axis][i] = at % kTableSide * kValueSteps[axis];
    }
  }
  for (unsigned i = 0; i < Size; ++i) {
    for (unsigned j = 0; j < Size; ++j) {
      for (unsigned k = 0; k < Size; ++k) {
        values[next++] = table.blocks[block[0][i] + block[1][j] + block[2][k]][value[0][i] + value[1][j] + value[2][k]];
      }
    }
  }
  return values;
}

/// Asks for the memory that gather() will read.
template <unsigned Size>
void prefetch(const BlockTable& table, const Place& first) {
  // A row of a block is half a cache line: the first and the last row of each layer bring those between along.
  for (unsigned i = 0; i < Size; ++i) {
    for (unsigned j = 0; j < Size; j += Size - 1) {
      const Place row{first[0] + i, first[1] + j, first[2]};
      __builtin_prefetch(table.blocks[block_at(table, row)] +
                         ((row[0] % kTableSide * kTableSide + row[1] % kTableSide) * kTableSide + row[2] % kTableSide));
    }
  }
}

/// As OpenVDB's BoxSampler rounds: difference and sum in float, the product in double.
float between(float a, float b, double weight) { return a + static_cast<float>(static_cast<double>(b - a) * weight); }

float linear_value(const Values<2>& v, const Vec3& weight) {
  return between(between(between(v[0], v[1], weight.z()), between(v[2], v[3], weight.z()), weight.y()),
                 between(between(v[4], v[5], weight.z()), between(v[6], v[7], weight.z()), weight.y()), weight.x());
}

Vec3 linear_slope(const Values<2>& values, const Vec3& weight) {
  std::array<double, 8> v{};
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = static_cast<double>(values[i]);
  const auto mix = [](double a, double b, double w) { return a + (b - a) * w; };
  const double x0z0 = mix(v[0], v[2], weight.y());
  const double x0z1 = mix(v[1], v[3], weight.y());
  const double x1z0 = mix(v[4], v[6], weight.y());
  const double x1z1 = mix(v[5], v[7], weight.y());
  return {mix(x1z0 - x0z0, x1z1 - x0z1, weight.z()),
          mix(mix(v[2] - v[0], v[3] - v[1], weight.z()), mix(v[6] - v[4], v[7] - v[5], weight.z()), weight.x()),
          mix(x0z1 - x0z0, x1z1 - x1z0, weight.x())};
}

/// The parabola through a, b and c at -1, 0 and 1.
struct Parabola {
  double half_bend;
  double slope;
  double middle;
  Parabola(double a, double b, double c) : half_bend(0.5 * (a + c) - b), slope(0.5 * (c - a)), middle(b) {}
  double value(double t) const { return t * (t * half_bend + slope) + middle; }
  double slope_at(double t) const { return 2.0 * t * half_bend + slope; }
};

template <bool WithSlope>
double quadratic_value(const Values<3>& v, const Vec3& t, Vec3& slope) {
  std::array<double, 3> value_x{};
  std::array<double, 3> slope_y{};
  std::array<double, 3> slope_z{};
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<double, 3> value_y{};
    std::array<double, 3> slope_z_y{};
    for (std::size_t j = 0; j < 3; ++j) {
      const float* const row = &v[9 * i + 3 * j];
      const Parabola along_z(static_cast<double>(row[0]), static_cast<double>(row[1]), static_cast<double>(row[2]));
      value_y[j] = along_z.value(t.z());
      if constexpr (WithSlope) slope_z_y[j] = along_z.slope_at(t.z());
    }
    const Parabola along_y(value_y[0], value_y[1], value_y[2]);
    value_x[i] = along_y.value(t.y());
    if constexpr (WithSlope) {
      slope_y[i] = along_y.slope_at(t.y());
      slope_z[i] = Parabola(slope_z_y[0], slope_z_y[1], slope_z_y[2]).value(t.y());
    }
  }
  const Parabola along_x(value_x[0], value_x[1], value_x[2]);
  if constexpr (WithSlope) {
    slope = {along_x.slope_at(t.x()), Parabola(slope_y[0], slope_y[1], slope_y[2]).value(t.x()),
             Parabola(slope_z[0], slope_z[1], slope_z[2]).value(t.x())};
  }
  return along_x.value(t.x());
}

}  // namespace

GridSampler::GridSampler(BlockTable table, const IndexMap& map) : table_(std::move(table)), map_(map) {
  // Stencils reach from one voxel below to two above. Those that this leaves out lie in the layer of background.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    low_index_[at] = table_.low[axis] + 1.0;
    end_index_[at] = table_.low[axis] + static_cast<double>(BlockTable::kSide) * table_.size[axis] - 2.0;
  }
}

bool GridSampler::holds(const Vec3& p_index) const {
  // Numbers that are none compare false.
  return p_index.x() >= low_index_.x() && p_index.x() < end_index_.x() && p_index.y() >= low_index_.y() &&
         p_index.y() < end_index_.y() && p_index.z() >= low_index_.z() && p_index.z() < end_index_.z();
}

/// The cube of values that a point needs, and where in it the point lies.
struct GridSampler::Stencil {
  Place first;
  Vec3 offset;        ///< from the lower corner of a cell, or from the middle voxel
  std::size_t point;  ///< in the batch
};

/// Points at a time: the memory of all is asked for before the first is computed, since random points wait for it
/// longer than for anything else.
struct GridSampler::Batch {
  static constexpr std::size_t kPoints = 64;
  std::array<Stencil, kPoints> stencils;
  std::size_t count = 0;

  /// Calls `visit(begin, size)` for pieces of `count` points.
  template <class Visit>
  static void for_each(std::size_t count, const Visit& visit) {
    for (std::size_t begin = 0; begin < count; begin += kPoints) visit(begin, std::min(kPoints, count - begin));
  }
};

/// Finds the stencils of Size voxels a side; instead calls `even(point, value)` for points outside the table, and for
/// those of three voxels of which all have one value.
template <unsigned Size, class Even>
void GridSampler::locate(std::span<const Vec3> points_mm, Batch& batch, const Even& even) const {
  batch.count = 0;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    const Vec3 p_index = map_.to_index(points_mm[i]);
    if (!holds(p_index)) {
      even(i, table_.background);
      continue;
    }
    // A cell starts below the point; three voxels have the nearest in their middle.
    constexpr bool kCell = Size == 2;
    constexpr double kRound = kCell ? 0.0 : 0.5;
    constexpr int kBelow = kCell ? 0 : 1;
    const int x = floor_of(p_index.x() + kRound);
    const int y = floor_of(p_index.y() + kRound);
    const int z = floor_of(p_index.z() + kRound);
    if constexpr (!kCell) {
      const std::size_t block = block_at(table_, place_of(table_, x, y, z));
      if (table_.is_even[block] != 0) {
        even(i, *table_.blocks[block]);
        continue;
      }
    }
    Stencil& stencil = batch.stencils[batch.count++];
    stencil.first = place_of(table_, x - kBelow, y - kBelow, z - kBelow);
    stencil.offset = p_index - Vec3(x, y, z);
    stencil.point = i;
  }
}

template <unsigned Size>
void GridSampler::prefetch_values(const Batch& batch) const {
  for (std::size_t i = 0; i < batch.count; ++i) prefetch<Size>(table_, batch.stencils[i].first);
}

void GridSampler::linear(std::span<const Vec3> points_mm, std::span<float> values, std::span<Vec3> gradients) const {
  Batch batch;
  Batch::for_each(points_mm.size(), [&](std::size_t begin, std::size_t size) {
    const auto even = [&](std::size_t i, float value) {
      values[begin + i] = value;
      if (!gradients.empty()) gradients[begin + i].setZero();
    };
    locate<2>(points_mm.subspan(begin, size), batch, even);
    prefetch_values<2>(batch);
    for (std::size_t i = 0; i < batch.count; ++i) {
      const Stencil& stencil = batch.stencils[i];
      const Values<2> corners = gather<2>(table_, stencil.first);
      values[begin + stencil.point] = linear_value(corners, stencil.offset);
      if (gradients.empty()) continue;
      gradients[begin + stencil.point] = map_.gradient_to_patient(linear_slope(corners, stencil.offset));
    }
  });
}

template <class Value>
void GridSampler::quadratic_of(std::span<const Vec3> points_mm, std::span<Value> values,
                               std::span<Vec3> gradients) const {
  Batch batch;
  Batch::for_each(points_mm.size(), [&](std::size_t begin, std::size_t size) {
    const auto even = [&](std::size_t i, float value) {
      values[begin + i] = static_cast<Value>(value);
      if (!gradients.empty()) gradients[begin + i].setZero();
    };
    locate<3>(points_mm.subspan(begin, size), batch, even);
    prefetch_values<3>(batch);
    for (std::size_t i = 0; i < batch.count; ++i) {
      const Stencil& stencil = batch.stencils[i];
      const Values<3> around = gather<3>(table_, stencil.first);
      Vec3 slope;
      if (gradients.empty()) {
        values[begin + stencil.point] = static_cast<Value>(quadratic_value<false>(around, stencil.offset, slope));
      } else {
        values[begin + stencil.point] = static_cast<Value>(quadratic_value<true>(around, stencil.offset, slope));
        gradients[begin + stencil.point] = map_.gradient_to_patient(slope);
      }
    }
  });
}

namespace {

/// Of the box of values that a lattice needs: bones' voxels are as large as the lattice's, or larger.
constexpr unsigned kMaxSide = 20;

}  // namespace

/// A box of values, z fastest, and where in it a lattice's positions lie.
struct GridSampler::Region {
  Place first;
  std::array<unsigned, 3> size;
  std::array<std::array<unsigned, LatticeBlock::kSide>, 3> cell;  ///< of each coordinate, from `first`
  std::array<std::array<double, LatticeBlock::kSide>, 3> weight;
};

bool GridSampler::find_region(const LatticeBlock& block, Region& region) const {
  if (!map_.axis_aligned || !(map_.per_mm.minCoeff() > 0.0)) return false;
  Vec3 low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[static_cast<Eigen::Index>(axis)] = block.at_mm[axis].front();
    high[static_cast<Eigen::Index>(axis)] = block.at_mm[axis].back();
  }
  if (!holds(map_.to_index(low)) || !holds(map_.to_index(high))) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    std::array<int, LatticeBlock::kSide> floors{};
    for (std::size_t n = 0; n < LatticeBlock::kSide; ++n) {
      const double index = (block.at_mm[axis][n] - map_.origin_mm[at]) * map_.per_mm[at];
      floors[n] = floor_of(index);
      region.weight[axis][n] = index - floors[n];
    }
    region.first[axis] = static_cast<unsigned>(floors.front() - table_.low[axis]);
    for (std::size_t n = 0; n < LatticeBlock::kSide; ++n) {
      region.cell[axis][n] = static_cast<unsigned>(floors[n] - floors.front());
    }
    region.size[axis] = region.cell[axis].back() + 2;
    if (region.size[axis] > kMaxSide) return false;
  }
  return true;
}

namespace {

/// Calls visit(x, y, row) with the values of each row along z.
template <class Visit>
void for_each_row(const BlockTable& table, const Place& first, const std::array<unsigned, 3>& size,
                  const Visit& visit) {
  std::array<float, kMaxSide> row;
  for (unsigned x = 0; x < size[0]; ++x) {
    for (unsigned y = 0; y < size[1]; ++y) {
      Place at{first[0] + x, first[1] + y, first[2]};
      const unsigned in_block = (at[0] % kTableSide * kTableSide + at[1] % kTableSide) * kTableSide;
      for (unsigned z = 0; z < size[2];) {
        const unsigned from = at[2] % kTableSide;
        const unsigned count = std::min(kTableSide - from, size[2] - z);
        std::copy_n(table.blocks[block_at(table, at)] + in_block + from, count, row.data() + z);
        z += count;
        at[2] += count;
      }
      visit(x, y, row.data());
    }
  }
}

}  // namespace

int GridSampler::sign(const LatticeBlock& block) const {
  Region region;
  if (!find_region(block, region)) return 0;
  bool some_negative = false;
  bool some_not = false;
  for_each_row(table_, region.first, region.size, [&](unsigned, unsigned, const float* row) {
    for (unsigned z = 0; z < region.size[2]; ++z) {
      some_negative |= row[z] < 0.0F;
      some_not |= !(row[z] < 0.0F);
    }
  });
  // What lies between values has their sign.
  return some_negative && some_not ? 0 : some_negative ? -1 : 1;
}

void GridSampler::linear(const LatticeBlock& block, std::span<float, 512> values) const {
  constexpr std::size_t kSide = LatticeBlock::kSide;
  Region region;
  if (!find_region(block, region)) {
    std::array<Vec3, 512> points_mm;
    for (std::size_t n = 0; n < points_mm.size(); ++n) points_mm[n] = block.position_mm(n);
    return linear(points_mm, values, {});
  }
  // Axis by axis, in linear_value()'s order: what it would work out again for every position is worked out once.
  std::array<float, kMaxSide * kMaxSide * kSide> along_z;
  for_each_row(table_, region.first, region.size, [&](unsigned x, unsigned y, const float* row) {
    float* const out = &along_z[(x * region.size[1] + y) * kSide];
    for (std::size_t k = 0; k < kSide; ++k) {
      const unsigned cell = region.cell[2][k];
      out[k] = between(row[cell], row[cell + 1], region.weight[2][k]);
    }
  });
  std::array<float, kMaxSide * kSide * kSide> along_y;
  for (unsigned x = 0; x < region.size[0]; ++x) {
    for (std::size_t j = 0; j < kSide; ++j) {
      const float* const low = &along_z[(x * region.size[1] + region.cell[1][j]) * kSide];
      float* const out = &along_y[(x * kSide + j) * kSide];
      for (std::size_t k = 0; k < kSide; ++k) out[k] = between(low[k], low[kSide + k], region.weight[1][j]);
    }
  }
  for (std::size_t i = 0; i < kSide; ++i) {
    const float* const low = &along_y[region.cell[0][i] * kSide * kSide];
    float* const out = &values[i * kSide * kSide];
    for (std::size_t n = 0; n < kSide * kSide; ++n) {
      out[n] = between(low[n], low[kSide * kSide + n], region.weight[0][i]);
    }
  }
}

void GridSampler::quadratic(std::span<const Vec3> points_mm, std::span<float> values, std::span<Vec3> gradients) const {
  quadratic_of(points_mm, values, gradients);
}

void GridSampler::quadratic(std::span<const Vec3> points_mm, std::span<double> values,
                            std::span<Vec3> gradients) const {
  quadratic_of(points_mm, values, gradients);
}

void GridSampler::negative(std::span<const Vec3> points_mm, std::span<std::uint8_t> result) const {
  Batch batch;
  Batch::for_each(points_mm.size(), [&](std::size_t begin, std::size_t size) {
    const auto even = [&](std::size_t i, float value) { result[begin + i] = value < 0.0F ? 1 : 0; };
    locate<2>(points_mm.subspan(begin, size), batch, even);
    std::array<const CellSigns::Layer*, Batch::kPoints> layers;
    for (std::size_t i = 0; i < batch.count; ++i) {
      const Place& first = batch.stencils[i].first;
      layers[i] = &table_.signs[table_.sign_places[block_at(table_, first)]].layers[first[0] % kTableSide];
      __builtin_prefetch(layers[i]);
    }
    // Those whose bits do not decide move to the front of the batch, without a branch that no one could foresee.
    std::size_t unsure = 0;
    for (std::size_t i = 0; i < batch.count; ++i) {
      const Stencil stencil = batch.stencils[i];
      const unsigned bit = stencil.first[1] % kTableSide * kTableSide + stencil.first[2] % kTableSide;
      result[begin + stencil.point] = static_cast<std::uint8_t>((layers[i]->negative >> bit) & 1U);
      batch.stencils[unsure] = stencil;
      unsure += (layers[i]->mixed >> bit) & 1U;
    }
    batch.count = unsure;
    prefetch_values<2>(batch);
    for (std::size_t i = 0; i < batch.count; ++i) {
      const Stencil& stencil = batch.stencils[i];
      const float value = linear_value(gather<2>(table_, stencil.first), stencil.offset);
      result[begin + stencil.point] = value < 0.0F ? 1 : 0;
    }
  });
}

}  // namespace spinaltap::detail

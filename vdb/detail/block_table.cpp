#include "vdb/detail/block_table.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <unordered_set>

namespace spinaltap::detail {
namespace {

/// Places in `signs` that blocks of one sign share.
constexpr std::uint32_t kAllPositive = 0;
constexpr std::uint32_t kAllNegative = 1;
constexpr std::uint32_t kFirstOwn = 2;

enum class Sign : std::uint8_t { positive, negative, both };

Sign sign_of(const float* values) {
  int negative = 0;
  for (int i = 0; i < BlockTable::kValues; ++i) negative += values[i] < 0.0F ? 1 : 0;
  if (negative == 0) return Sign::positive;
  return negative == BlockTable::kValues ? Sign::negative : Sign::both;
}

/// The sign bits of the nine voxels along z from (x, y, 0) of the block on; x and y reach 8.
unsigned row_signs(const BlockTable& table, std::size_t block, unsigned x, unsigned y) {
  const std::size_t at = block + (x / kTableSide) * table.offset(1, 0, 0) + (y / kTableSide) * table.offset(0, 1, 0);
  const unsigned first = (x % kTableSide * kTableSide + y % kTableSide) * kTableSide;
  unsigned bits = table.blocks[at + 1][first] < 0.0F ? 1U << kTableSide : 0U;
  for (unsigned z = 0; z < kTableSide; ++z) bits |= table.blocks[at][first + z] < 0.0F ? 1U << z : 0U;
  return bits;
}

CellSigns cell_signs(const BlockTable& table, std::size_t block) {
  std::array<std::array<unsigned, kTableSide + 1>, kTableSide + 1> rows{};
  for (unsigned x = 0; x <= kTableSide; ++x) {
    for (unsigned y = 0; y <= kTableSide; ++y) rows[x][y] = row_signs(table, block, x, y);
  }
  CellSigns signs;
  for (unsigned x = 0; x < kTableSide; ++x) {
    for (unsigned y = 0; y < kTableSide; ++y) {
      const unsigned all = rows[x][y] & rows[x][y + 1] & rows[x + 1][y] & rows[x + 1][y + 1];
      const unsigned any = rows[x][y] | rows[x][y + 1] | rows[x + 1][y] | rows[x + 1][y + 1];
      const std::uint64_t negative = all & (all >> 1U) & 0xFFU;
      const std::uint64_t touched = (any | (any >> 1U)) & 0xFFU;
      signs.layers[x].negative |= negative << (kTableSide * y);
      signs.layers[x].mixed |= (touched & ~negative) << (kTableSide * y);
    }
  }
  return signs;
}

}  // namespace

void find_even_blocks(BlockTable& table) {
  // Runs of three equal blocks along z, then along y, then along x. The outermost blocks are asked for nothing.
  table.is_even.assign(table.blocks.size(), 0);
  if (table.blocks.empty()) return;
  std::unordered_set<const float*> shared;
  for (const auto& block : table.constants) {
    if (std::isfinite(block->front())) shared.insert(block->data());
  }
  for (std::size_t i = 0; i < table.blocks.size(); ++i) table.is_even[i] = shared.contains(table.blocks[i]) ? 1 : 0;
  for (const std::size_t step : {std::size_t{1}, table.offset(0, 1, 0), table.offset(1, 0, 0)}) {
    const std::vector<std::uint8_t> before = table.is_even;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const bool has_both = i >= step && i + step < before.size();
      const bool is_same = has_both && before[i - step] != 0 && before[i] != 0 && before[i + step] != 0 &&
                           table.blocks[i - step] == table.blocks[i] && table.blocks[i + step] == table.blocks[i];
      table.is_even[i] = is_same ? 1 : 0;
    }
  }
}

void find_signs(BlockTable& table) {
  if (table.blocks.empty()) return;
  std::vector<Sign> own(table.blocks.size());
  tbb::parallel_for(std::size_t{0}, own.size(), [&](std::size_t i) { own[i] = sign_of(table.blocks[i]); });

  table.signs.assign(kFirstOwn, {});
  for (CellSigns::Layer& layer : table.signs[kAllNegative].layers) layer.negative = ~std::uint64_t{0};
  // No cell that is asked for starts in the last layer of blocks, which is background.
  table.sign_places.assign(own.size(), table.background < 0.0F ? kAllNegative : kAllPositive);
  std::vector<std::size_t> mixed;
  const auto last = [&](std::size_t axis) { return static_cast<unsigned>(table.size[axis] - 1); };
  for (unsigned x = 0; x < last(0); ++x) {
    for (unsigned y = 0; y < last(1); ++y) {
      for (unsigned z = 0; z < last(2); ++z) {
        const std::size_t block = table.offset(x, y, z);
        bool same = own[block] != Sign::both;
        for (unsigned next = 1; next < 8 && same; ++next) {
          same = own[table.offset(x + (next & 1U), y + ((next >> 1U) & 1U), z + (next >> 2U))] == own[block];
        }
        if (same) {
          table.sign_places[block] = own[block] == Sign::negative ? kAllNegative : kAllPositive;
        } else {
          table.sign_places[block] = static_cast<std::uint32_t>(kFirstOwn + mixed.size());
          mixed.push_back(block);
        }
      }
    }
  }
  table.signs.resize(kFirstOwn + mixed.size());
  tbb::parallel_for(std::size_t{0}, mixed.size(),
                    [&](std::size_t i) { table.signs[kFirstOwn + i] = cell_signs(table, mixed[i]); });
}

}  // namespace spinaltap::detail

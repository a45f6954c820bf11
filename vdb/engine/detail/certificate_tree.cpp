#include "vdb/engine/detail/certificate_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace spinaltap::detail {

CertificateTree::CertificateTree(std::vector<Level> levels) {
  for (Level& level : levels) {
    const std::size_t count = level.centres_mm.size();
    levels_.push_back({MoveCertificates(level.centres_mm, level.half_mm), std::vector<float>(count),
                       std::vector<std::uint8_t>(count), std::move(level.begin), std::move(level.count),
                       std::vector<std::uint32_t>(count)});
    top_count_ = count;
    level = {};
  }
}

std::span<const std::uint32_t> CertificateTree::due(const SweptBounds& tool) noexcept {
  for (Boxes& level : levels_) {
    level.certificates.move_to(tool.line());
    level.due_count = 0;
  }
  list_due(levels_.size() - 1, 0, top_count_, tool);
  return std::span(levels_.front().due).first(levels_.front().due_count);
}

/// Of [begin, end) of a level: certificates that hold, those that can be renewed, and, below the rest, what is due.
void CertificateTree::list_due(std::size_t number, std::size_t begin, std::size_t end,
                               const SweptBounds& tool) noexcept {
  levels_[number].certificates.check(begin, end, levels_[number].left_mm.data() + begin);
  list_failed(number, begin, end, tool);
}

void CertificateTree::list_failed(std::size_t number, std::size_t begin, std::size_t end,
                                  const SweptBounds& tool) noexcept {
  Boxes& level = levels_[number];
  const double half_mm = level.certificates.half_mm();
  for (std::size_t n = begin; n < end; ++n) {
    if (level.left_mm[n] > 0.0F) continue;
    if (number == 0) {
      level.due[level.due_count++] = static_cast<std::uint32_t>(n);
      continue;
    }
    const FreeMove free = tool.free_of_ball(tool.place(level.certificates.centre_mm(n)), half_mm, 0.25 * half_mm);
    if (free.free_mm > 0.0) {
      level.certificates.renew(n, free);
      level.left_mm[n] = static_cast<float>(free.free_mm * (1.0 - 1e-6));
      level.is_stale[n] = 1;
      continue;
    }
    level.due[level.due_count++] = static_cast<std::uint32_t>(n);
    const std::size_t first = level.begin[n], count = level.count[n];
    if (level.is_stale[n] != 0) {
      // The tool may have been anywhere since these were checked.
      Boxes& below = levels_[number - 1];
      std::fill_n(below.left_mm.data() + first, count, kUnknownMm);
      std::fill_n(below.is_stale.data() + first, count, std::uint8_t{1});
      level.is_stale[n] = 0;
      list_failed(number - 1, first, first + count, tool);
    } else {
      list_due(number - 1, first, first + count, tool);
    }
  }
}

void CertificateTree::certify(std::size_t box, const FreeMove& free) noexcept {
  Boxes& lowest = levels_.front();
  lowest.certificates.renew(box, free);
  lowest.left_mm[box] = static_cast<float>(std::min(free.free_mm, free.rest_mm));
}

FreeMove CertificateTree::together(const Boxes& level, std::size_t begin, std::size_t count) noexcept {
  if (count == 0) return {static_cast<double>(kEmptyMm), 0.0, 0.0};
  return level.certificates.together(begin, begin + count, level.left_mm.data());
}

void CertificateTree::renew(Boxes& level, std::size_t box, const FreeMove& of_children) noexcept {
  FreeMove free = of_children;
  if (free.free_mm > static_cast<double>(kEmptyMm)) free.free_mm -= 1e-6 * std::abs(free.free_mm);  // rounded down
  level.certificates.renew(box, free);
  level.left_mm[box] = static_cast<float>(free.free_mm);
}

void CertificateTree::Boxes::move(std::size_t from, std::size_t to) noexcept {
  if (from == to) return;
  certificates.copy(from, to);
  left_mm[to] = left_mm[from];
  is_stale[to] = is_stale[from];
  if (begin.empty()) return;
  begin[to] = begin[from];
  count[to] = count[from];
}

std::size_t CertificateTree::memory_bytes() const {
  std::size_t bytes = 0;
  for (const Boxes& level : levels_) {
    bytes += level.certificates.memory_bytes() + level.left_mm.size() * sizeof(float) + level.is_stale.size() +
             (level.begin.size() + level.count.size() + level.due.size()) * sizeof(std::uint32_t);
  }
  return bytes;
}

}  // namespace spinaltap::detail

#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace spinaltap::test {

/// What lies along a line through a bone, from before its entry to beyond it.
struct LineProfile {
  double begin_mm = 0.0, step_mm = 0.0;  ///< of the first place, and between places
  std::vector<double> inside_mm;         ///< to the bone's surface, in it; negative outside
  std::vector<double> density_g_cm3;     ///< as the CT shows it

  double at_mm(std::size_t n) const { return begin_mm + step_mm * static_cast<double>(n); }
};

/// Where a line meets a bone's walls, mm along it; not a number where there is no such wall.
struct WallsMet {
  double outer_mm = std::nan("");
  double cortex_end_mm = std::nan("");
  double far_cortex_mm = std::nan("");
  double end_mm = std::nan("");
};

/// Read off the whole profile: the bone from its surface at the entry to where the line comes out again; its cancellous
/// bone, the median of what lies 5 mm from both; a cortex, the densest within 4 mm of a surface, where it is a quarter
/// denser than that. A cortex ends half way between both densities (full width at half maximum, as cortical thickness
/// is read off CTs: Prevrhal, Engelke and Kalender 1999).
inline WallsMet read_walls(const LineProfile& profile) {
  constexpr double kRise = 1.25, kCortexMm = 4.0, kMiddleMm = 5.0, kEntryMm = 3.0;
  WallsMet met;
  const std::size_t count = profile.inside_mm.size();
  std::size_t first = count, last = count;
  for (std::size_t n = 1; n < count; ++n) {
    const bool is_inside = profile.inside_mm[n] > 0.0, was_inside = profile.inside_mm[n - 1] > 0.0;
    const double share = profile.inside_mm[n - 1] / (profile.inside_mm[n - 1] - profile.inside_mm[n]);
    const double at_mm = profile.at_mm(n - 1) + share * profile.step_mm;
    if (first == count && is_inside && !was_inside && std::abs(at_mm) < kEntryMm) {
      first = n;
      met.outer_mm = at_mm;
    }
    if (first < count && !is_inside && was_inside) {
      last = n;
      met.end_mm = at_mm;
      break;
    }
  }
  if (last == count) return met;
  std::vector<double> middle;
  for (std::size_t n = first; n < last; ++n) {
    const double at_mm = profile.at_mm(n);
    if (at_mm > met.outer_mm + kMiddleMm && at_mm < met.end_mm - kMiddleMm) middle.push_back(profile.density_g_cm3[n]);
  }
  if (middle.empty()) return met;
  std::nth_element(middle.begin(), middle.begin() + static_cast<std::ptrdiff_t>(middle.size() / 2), middle.end());
  const double cancellous = middle[middle.size() / 2];
  std::size_t entry_peak = first, far_peak = last - 1;
  for (std::size_t n = first; n < last; ++n) {
    const double at_mm = profile.at_mm(n), density = profile.density_g_cm3[n];
    if (at_mm < met.outer_mm + kCortexMm && density > profile.density_g_cm3[entry_peak]) entry_peak = n;
    if (at_mm > met.end_mm - kCortexMm && density > profile.density_g_cm3[far_peak]) far_peak = n;
  }
  const auto half = [&](std::size_t peak) { return 0.5 * (profile.density_g_cm3[peak] + cancellous); };
  if (profile.density_g_cm3[entry_peak] >= kRise * cancellous) {
    std::size_t n = entry_peak;
    while (n < last && profile.density_g_cm3[n] >= half(entry_peak)) ++n;
    met.cortex_end_mm = profile.at_mm(n);
  }
  if (profile.density_g_cm3[far_peak] >= kRise * cancellous) {
    std::size_t n = far_peak;
    while (n > first && profile.density_g_cm3[n] >= half(far_peak)) --n;
    met.far_cortex_mm = profile.at_mm(n + 1);
  }
  return met;
}

}  // namespace spinaltap::test

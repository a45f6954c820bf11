#include "core/grading/detail/tool_sections.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace spinaltap {
namespace {

/// A unit vector of the plane at right angles to `axis`, `turn` of a whole turn round.
Vec3 across(const Vec3& axis, const Vec3& first, double turn) {
  const double angle = 2.0 * std::numbers::pi * turn;
  return std::cos(angle) * first + std::sin(angle) * axis.cross(first);
}

int places_of(int annulus) { return 4 * (2 * annulus + 1); }

/// How far behind the tip an outline is first as wide as `radius_mm`, which is at most its widest.
double first_as_wide_mm(const BitProfile& outline, double radius_mm) {
  if (outline.widest_mm(0.0, 0.0) >= radius_mm) return 0.0;
  double narrower_mm = 0.0;
  double as_wide_mm = outline.length_mm();
  for (int halving = 0; halving < 40; ++halving) {
    const double middle_mm = 0.5 * (narrower_mm + as_wide_mm);
    (outline.widest_mm(0.0, middle_mm) < radius_mm ? narrower_mm : as_wide_mm) = middle_mm;
  }
  return as_wide_mm;
}

}  // namespace

ToolSections::ToolSections(const BoneShape& bone,
                           const std::function<void(std::span<const Vec3>, std::span<float>)>& hu,
                           const Material& material, const GradedTool& tool, const DrillBit& bit, double rpm,
                           std::span<const double> depths_mm, double step_mm, std::span<const double> hu_bands)
    : widest_mm_(tool.widest_mm()),
      bit_(bit),
      law_(bit, material),
      rpm_(rpm),
      step_mm_(step_mm),
      band_count_(hu_bands.size() + 1) {
  const BitProfile outline(bit);
  for (std::size_t n = 0; n < kAnnuli; ++n) {
    const double share = (static_cast<double>(n) + 0.5) / kAnnuli;
    middle_mm_[n] = share * tool.widest_mm();
    bit_back_mm_[n] = first_as_wide_mm(outline, share * bit.radius_mm());
  }
  // A tip at the entry has its wider part behind, where a slanting surface may have bone.
  lead_ = static_cast<std::size_t>(std::ceil(bit_back_mm_.back() / step_mm));
  for (std::size_t n = lead_; n > 0; --n) depths_mm_.push_back(-step_mm * static_cast<double>(n));
  depths_mm_.insert(depths_mm_.end(), depths_mm.begin(), depths_mm.end());
  for (const double depth_mm : depths_mm) radii_mm_.push_back(tool.radius_mm(depth_mm));

  std::vector<Vec3> places_mm;
  places_mm.reserve(depths_mm_.size() * kPoints);
  for (const double depth_mm : depths_mm_) {
    const Vec3 centre_mm = tool.axis_mm(depth_mm), axis = tool.direction_at(depth_mm), first = tool.across_at(depth_mm);
    for (int annulus = 0; annulus < kAnnuli; ++annulus) {
      const int count = places_of(annulus);
      for (int n = 0; n < count; ++n) {
        const Vec3 place_mm = middle_mm_[static_cast<std::size_t>(annulus)] * across(axis, first, (n + 0.5) / count);
        places_mm.push_back(centre_mm + place_mm);
      }
    }
  }
  const std::vector<float> values_hu = hu_inside_bone(bone, hu, places_mm);

  sections_.resize(depths_mm_.size());
  std::size_t place = 0;
  for (Section& section : sections_) {
    for (int annulus = 0; annulus < kAnnuli; ++annulus) {
      Sums& sums = section[static_cast<std::size_t>(annulus)];
      sums.bands.assign(band_count_, 0);
      for (int n = 0; n < places_of(annulus); ++n, ++place) {
        const auto value_hu = static_cast<double>(values_hu[place]);
        if (!std::isfinite(value_hu)) continue;
        ++sums.count;
        sums.hu += value_hu;
        sums.specific_cutting_energy_mpa += material.cutting_energy_mpa(value_hu);
        if (annulus == 0) sums.chisel_mpa += material.chisel_pressure_mpa(value_hu);
        const auto band = std::upper_bound(hu_bands.begin(), hu_bands.end(), value_hu) - hu_bands.begin();
        ++sums.bands[static_cast<std::size_t>(band)];
      }
    }
  }
}

bool ToolSections::holds(std::size_t annulus, std::size_t n) const {
  // The very tip still has a CT number: that on its axis.
  return annulus == 0 || middle_mm_[annulus] <= radii_mm_[n];
}

double ToolSections::hu(std::size_t n) const {
  int count = 0;
  double sum = 0.0;
  for (std::size_t annulus = 0; annulus < kAnnuli; ++annulus) {
    if (!holds(annulus, n)) continue;
    count += at(n)[annulus].count;
    sum += at(n)[annulus].hu;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

double ToolSections::weight_mm(std::size_t n) const {
  const std::size_t before = n > 0 ? n - 1 : n;
  const std::size_t after = std::min(n + 1, radii_mm_.size() - 1);
  return 0.5 * (depths_mm_[lead_ + after] - depths_mm_[lead_ + before]);
}

double ToolSections::mean_hu() const {
  double volume = 0.0;
  double sum = 0.0;
  for (std::size_t n = 0; n < radii_mm_.size(); ++n) {
    for (std::size_t annulus = 0; annulus < kAnnuli; ++annulus) {
      if (!holds(annulus, n)) continue;
      volume += weight_mm(n) * at(n)[annulus].count;
      sum += weight_mm(n) * at(n)[annulus].hu;
    }
  }
  return volume > 0.0 ? sum / volume : std::numeric_limits<double>::quiet_NaN();
}

double ToolSections::add_bands(std::size_t n, double weight, std::vector<double>& bands) const {
  double sum = 0.0;
  for (std::size_t annulus = 0; annulus < kAnnuli; ++annulus) {
    if (!holds(annulus, n)) continue;
    sum += weight * at(n)[annulus].count;
    for (std::size_t band = 0; band < band_count_; ++band) bands[band] += weight * at(n)[annulus].bands[band];
  }
  return sum;
}

std::vector<double> ToolSections::band_shares(std::size_t n) const {
  std::vector<double> shares(band_count_, 0.0);
  const double area = add_bands(n, 1.0, shares);
  for (double& share : shares) share = area > 0.0 ? share / area : 0.0;
  return shares;
}

std::vector<double> ToolSections::band_shares() const {
  std::vector<double> shares(band_count_, 0.0);
  double volume = 0.0;
  for (std::size_t n = 0; n < radii_mm_.size(); ++n) volume += add_bands(n, weight_mm(n), shares);
  for (double& share : shares) share = volume > 0.0 ? share / volume : 0.0;
  return shares;
}

double ToolSections::mean_mpa(std::size_t annulus, double depth_mm, double Sums::*sum) const {
  const double index =
      std::clamp((depth_mm - depths_mm_.front()) / step_mm_, 0.0, static_cast<double>(depths_mm_.size() - 1));
  const auto below = std::min(static_cast<std::size_t>(index), depths_mm_.size() - 1);
  const std::size_t above = std::min(below + 1, depths_mm_.size() - 1);
  const double low_mpa = sections_[below][annulus].*sum;
  const double high_mpa = sections_[above][annulus].*sum;
  const double gap_mm = depths_mm_[above] - depths_mm_[below];
  const double share = gap_mm > 0.0 ? std::clamp((depth_mm - depths_mm_[below]) / gap_mm, 0.0, 1.0) : 0.0;
  return (low_mpa + share * (high_mpa - low_mpa)) / places_of(static_cast<int>(annulus));
}

CuttingResistance ToolSections::resistance(std::size_t n) const {
  const double tip_mm = depths_mm_[lead_ + n];
  const double section_mm2 = std::numbers::pi * bit_.radius_mm() * bit_.radius_mm();
  double energy_n = 0.0;
  for (std::size_t annulus = 0; annulus < kAnnuli; ++annulus) {
    // The bit is not as wide as the screw that the hole is for: the sections' annulus that lies at the same radius.
    const double share = (static_cast<double>(annulus) + 0.5) / kAnnuli * bit_.radius_mm() / widest_mm_;
    const auto met = std::min<std::size_t>(static_cast<std::size_t>(share * kAnnuli), kAnnuli - 1);
    const double area_mm2 = section_mm2 * places_of(static_cast<int>(annulus)) / kPoints;
    energy_n += area_mm2 * mean_mpa(met, tip_mm - bit_back_mm_[annulus], &Sums::specific_cutting_energy_mpa);
  }
  return law_.resistance({energy_n, mean_mpa(0, tip_mm, &Sums::chisel_mpa)}, rpm_);
}

}  // namespace spinaltap

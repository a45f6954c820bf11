#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "core/anatomy/inside_bone.h"
#include "core/force/drill_forces.h"
#include "core/grading/detail/graded_tool.h"

namespace spinaltap {

/// The bone that a tool meets, in sections across its path: places of equal shares of the widest section, in annuli.
class ToolSections {
 public:
  static constexpr int kAnnuli = 4;
  static constexpr int kPoints = 4 * kAnnuli * kAnnuli;

  /// `bit`, at `rpm`, drills the tool's hole. `depths_mm`: ascending, from 0 to the path's length, `step_mm` apart
  /// except for the last. `hu_bands`: borders.
  ToolSections(const BoneShape& bone, const std::function<void(std::span<const Vec3>, std::span<float>)>& hu,
               const Material& material, const GradedTool& tool, const DrillBit& bit, double rpm,
               std::span<const double> depths_mm, double step_mm, std::span<const double> hu_bands);

  /// Mean CT number of the bone in the tool's own section at the n-th depth; NaN where there is none.
  double hu(std::size_t n) const;
  /// Shares of that bone by band, one more than there are borders; 0 without bone.
  std::vector<double> band_shares(std::size_t n) const;
  /// Of the tool's whole volume in bone; NaN where there is none.
  double mean_hu() const;
  /// Likewise of that volume.
  std::vector<double> band_shares() const;
  /// What the bone asks of the bit with its tip at the n-th depth: each annulus of the bit is cut where the tip first
  /// is as wide.
  CuttingResistance resistance(std::size_t n) const;

 private:
  /// Sums over the places of an annulus that are in bone.
  struct Sums {
    int count = 0;
    double hu = 0.0;
    double specific_cutting_energy_mpa = 0.0;
    double chisel_mpa = 0.0;
    std::vector<int> bands;
  };
  using Section = std::array<Sums, kAnnuli>;

  /// Mean over an annulus' places, those out of bone counted with nothing.
  double mean_mpa(std::size_t annulus, double depth_mm, double Sums::*sum) const;
  const Section& at(std::size_t n) const { return sections_[lead_ + n]; }
  bool holds(std::size_t annulus, std::size_t n) const;
  /// Adds what the section at the n-th depth has of each band, `weight` times; returns the sum.
  double add_bands(std::size_t n, double weight, std::vector<double>& bands) const;
  /// The length of the path for which the section at the n-th depth stands.
  double weight_mm(std::size_t n) const;

  std::vector<Section> sections_;
  std::vector<double> depths_mm_;  ///< of sections_, the first `lead_` of them before the entry
  std::size_t lead_ = 0;
  std::vector<double> radii_mm_;             ///< of the tool, one of each depth from the entry on
  std::array<double, kAnnuli> middle_mm_{};  ///< radius of each annulus
  double widest_mm_;
  DrillBit bit_;
  ToolLaw law_;
  double rpm_;
  std::array<double, kAnnuli> bit_back_mm_{};  ///< how far behind the tip each annulus of the bit is cut
  double step_mm_;
  std::size_t band_count_;
};

}  // namespace spinaltap

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace spinaltap {

/// What may differ between the runs of a study. The order is that of the columns of its table.
enum class StudyFactor : std::uint8_t {
  entry_left_mm,    ///< the bit's line lies so far towards the patient's left of the planned one
  entry_head_mm,    ///< and so far towards the head; both across the planned path
  angle_left_deg,   ///< the bit's line leans so far to the left, about its entry
  angle_head_deg,   ///< and to the head
  bit_diameter_mm,  ///< the tip keeps its shape: its length and its chisel edge go with the diameter
  push_n,           ///< of an operator that pushes
  feed_mm_s,        ///< of an operator that feeds
  tremor_mm,
  density_scale,  ///< of the bone, before the material's density calibration: 0.6 is osteoporosis
  force_scale     ///< of the forces that the bone asks: sources differ by as much
};
constexpr std::size_t kStudyFactors = 10;
/// "entry_left_mm", "entry_head_mm", ...: in specifications and as names of columns; the unit is in it.
std::string_view name_of(StudyFactor factor);
/// Every factor's value in one run; not a number for one that does not apply.
using FactorValues = std::array<double, kStudyFactors>;

/// How one factor differs.
struct FactorDistribution {
  enum class Kind : std::uint8_t {
    levels,   ///< each with every level of the other factors: a full factorial design
    normal,   ///< drawn; `a`: mean, `b`: deviation
    uniform,  ///< drawn; from `a` to `b`
    spread    ///< drawn; as a ForceSpread: `a`: median, `b`: scale of the logarithm; its outer 0.5 % are left out
  };
  StudyFactor factor = StudyFactor::entry_left_mm;
  Kind kind = Kind::levels;
  std::vector<double> levels = {};
  double a = 0.0;
  double b = 0.0;
  int degrees = 1;  ///< of freedom, of a spread
};

/// What the runs of a study are.
struct StudyDesign {
  std::vector<FactorDistribution> distributions;  ///< of the factors that differ, each at most once
  std::size_t runs = 1;                           ///< for each combination of levels
  /// Latin hypercube (McKay, Beckman & Conover 1979): of n runs, each n-th part of a drawn factor's probability is met
  /// by one. Otherwise every run is drawn for itself.
  bool is_latin = false;
  std::uint64_t seed = 1;
};

/// The runs of a design, drawn. Run n is the same whoever asks, in whatever order: its numbers come from a counter.
class StudyRuns {
 public:
  static constexpr std::size_t kMaxRuns = 1'000'000;

  /// Throws Error on a factor that is named twice, a distribution that makes no sense, no runs, and over kMaxRuns.
  explicit StudyRuns(StudyDesign design);

  std::size_t count() const { return count_; }
  const StudyDesign& design() const { return design_; }
  /// The values of run n; those of factors that do not differ are taken from `base`.
  FactorValues values(std::size_t n, const FactorValues& base) const;
  /// For all else that is random in run n: the operator's tremor. Below 2^32, so that every reader of tables keeps it.
  std::uint64_t seed_of(std::size_t n) const;
  /// Standard normal number `k` of six, for run n's error of registration.
  double registration_normal(std::size_t n, int k) const;

 private:
  double probability(std::size_t distribution, std::size_t n) const;

  StudyDesign design_;
  std::size_t count_ = 0;
  /// For each distribution that draws in a Latin hypercube: which stratum a run falls into.
  std::vector<std::vector<std::uint32_t>> strata_;
};

}  // namespace spinaltap

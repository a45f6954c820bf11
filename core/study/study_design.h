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
  density_scale,          ///< of the bone, before the material's density calibration: 0.6 is osteoporosis
  force_scale,            ///< of the forces that the bone asks: sources differ by as much
  entry_error_scale,      ///< of the entry's part of the errors of placement
  direction_error_scale,  ///< of the direction's part
  registration_scale      ///< of the registration's error
};
constexpr std::size_t kStudyFactors = 13;
/// "entry_left_mm", "entry_head_mm", ...: in specifications and as names of columns; the unit is in it.
std::string_view name_of(StudyFactor factor);
/// Every factor's value in one run; not a number for one that does not apply.
using FactorValues = std::array<double, kStudyFactors>;

/// For what a number is drawn anew: runs of one screw, and screws of one patient, may have it in common.
enum class DrawnPer : std::uint8_t { run, screw, patient };
/// As specs and tables have it.
std::string_view name_of(DrawnPer per);

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
  DrawnPer per = DrawnPer::run;
};

/// How runs are drawn.
enum class StudySampling : std::uint8_t {
  random,           ///< every run for itself
  latin_hypercube,  ///< of n runs each n-th part of a drawn factor's probability is met by one (McKay et al. 1979)
  /// In blocks, from which the factors' shares of the variance follow: two runs that share nothing, A and B, and for
  /// each input one run that is A but for that input, which it has from B (Saltelli et al. 2010).
  saltelli
};
/// As specs have it.
std::string_view name_of(StudySampling sampling);

/// What the runs of a study are.
struct StudyDesign {
  std::vector<FactorDistribution> distributions;  ///< of the factors that differ, each at most once
  /// For each screw and each combination of levels; of Saltelli's design: blocks.
  std::size_t runs = 1;
  StudySampling sampling = StudySampling::random;
  std::uint64_t seed = 1;
};

/// What is drawn beside factors. The first three are of the errors of placement: what is behind the entry's part, what
/// is behind the direction's and not behind the entry's too, and the rest.
enum class StudyDraw : std::uint8_t { entry, direction, along, registration, screw };
constexpr std::size_t kStudyDraws = 5;
/// As tables have it.
std::string_view name_of(StudyDraw draw);

/// What the runs of a study are shared out to, and what is drawn in them beside factors.
struct StudyGround {
  std::vector<std::size_t> patients{0};  ///< of each screw, counted from 0
  bool has_errors = false;               ///< of placement
  bool has_registration = false;
  DrawnPer registration_per = DrawnPer::run;
};

/// The runs of a design, drawn. Run n is the same whoever asks, in whatever order: its numbers come from a counter.
class StudyRuns {
 public:
  static constexpr std::size_t kMaxRuns = 1'000'000;

  /// Throws Error on a factor that is named twice, a distribution that makes no sense, no runs, no screws, over
  /// kMaxRuns, and on a Saltelli design with levels, or with nothing that is drawn.
  explicit StudyRuns(StudyDesign design, StudyGround ground = {});

  std::size_t count() const { return count_; }
  const StudyDesign& design() const { return design_; }
  /// All runs of the first screw come first; of Saltelli's design each run draws its screw.
  std::size_t screw_of(std::size_t n) const;
  std::size_t patient_of(std::size_t n) const { return ground_.patients[screw_of(n)]; }
  /// The values of run n; those of factors that do not differ are taken from `base`.
  FactorValues values(std::size_t n, const FactorValues& base) const;
  /// Standard normal numbers behind run n's error of placement: see error_of().
  std::array<double, 6> placement_normals(std::size_t n) const;
  /// The same, behind its error of registration.
  std::array<double, 6> registration_normals(std::size_t n) const;
  /// For all else that is random in run n: the operator's tremor. Below 2^32, so that every reader of tables keeps it.
  /// Runs of one block of Saltelli's have it in common.
  std::uint64_t seed_of(std::size_t n) const;

  /// What Saltelli's design has a run for in each block, after A and B: factors that are drawn, then StudyDraw's.
  const std::vector<std::string>& inputs() const { return inputs_; }

 private:
  std::size_t place_of(std::size_t n, DrawnPer per) const;
  double number(std::uint64_t stream, std::size_t input, std::size_t n, DrawnPer per, std::uint64_t k,
                std::uint64_t room) const;
  double probability(std::size_t distribution, std::size_t n) const;
  std::size_t input_of(StudyDraw draw) const { return draws_.at(static_cast<std::size_t>(draw)); }

  StudyDesign design_;
  StudyGround ground_;
  std::size_t count_ = 0;
  std::size_t runs_a_screw_ = 0;
  /// For each distribution that draws in a Latin hypercube: which stratum a run falls into.
  std::vector<std::vector<std::uint32_t>> strata_;
  std::vector<std::string> inputs_;
  std::array<std::size_t, kStudyDraws> draws_{};  ///< places of StudyDraw's in inputs_; beyond it: not drawn
};

}  // namespace spinaltap

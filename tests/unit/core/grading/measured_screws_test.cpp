#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/files/measurements_file.h"
#include "core/grading/screw_fixation.h"
#include "tests/support/foam_fixation_model.h"

namespace spinaltap {
namespace {

// The law of screws against what others measured: docs/screws.md has the table that this prints, and says where the
// values come from that stand in for what a source leaves open. None of the law's numbers was chosen by these rows.

/// What a source leaves open: every combination is worked out.
struct OpenValues {
  std::vector<PedicleScrew> screws;
  std::vector<double> holes_mm;
  std::vector<double> bones;  ///< HU of the body's cancellous bone; of foam its density, g/cm³
};

struct PredictedRange {
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  double log_sum = 0.0;
  int count = 0;
  FixationFigure widest{0.0, std::numeric_limits<double>::infinity(), 0.0};  ///< the bands of all together

  void add(double value, const FixationFigure& figure) {
    low = std::min(low, value);
    high = std::max(high, value);
    log_sum += std::log(value);
    ++count;
    widest.p05 = std::min(widest.p05, value * figure.p05 / figure.median);
    widest.p95 = std::max(widest.p95, value * figure.p95 / figure.median);
  }
  double middle() const { return std::exp(log_sum / count); }
};

struct ScrewAnswer {
  PredictedRange pullout, torque;
};

const PedicleScrew kThinScrew{"5.5 x 40 mm", 5.5, 40.0, 4.0};
const PedicleScrew kUsualScrew{"6.5 x 45 mm", 6.5, 45.0, 4.0};

DrillPath screwed_along_z(const PedicleScrew& screw, double hole_mm) {
  DrillPath path{"", Vec3::Zero(), Vec3(0.0, 0.0, screw.length_mm), {hole_mm, 50.0, 1.0}};
  path.screw = screw;
  return path;
}

constexpr double kInPedicle = 0.6;     // of the screw's length
constexpr double kPedicleShare = 1.6;  // CT number of the pedicle's cancellous bone over the body's

/// A vertebra as a screw meets it: the pedicle's cancellous bone, then the body's.
ScrewAnswer of_vertebra(const OpenValues& open, bool ends_in_pedicle = false) {
  ScrewAnswer answer;
  const HuToDensity calibration;
  for (const PedicleScrew& screw : open.screws) {
    for (const double hole_mm : open.holes_mm) {
      for (const double hu : open.bones) {
        const double pedicle_mm = kInPedicle * screw.length_mm;
        const ScrewFixation fixation =
            screw_fixation(screwed_along_z(screw, hole_mm), [&](std::span<const Vec3> p, std::span<double> g) {
              for (std::size_t n = 0; n < g.size(); ++n) {
                g[n] = calibration.density_g_cm3(p[n].z() < pedicle_mm ? kPedicleShare * hu : hu);
              }
            });
        answer.pullout.add(fixation.pullout_n.median, fixation.pullout_n);
        double torque_n_mm = fixation.max_torque_n_mm.median;
        if (ends_in_pedicle) {
          for (const FixationRow& row : fixation.rows) {
            if (row.depth_mm <= pedicle_mm) torque_n_mm = row.torque_n_mm;
          }
        }
        answer.torque.add(torque_n_mm, fixation.max_torque_n_mm);
      }
    }
  }
  return answer;
}

ScrewAnswer of_foam(const OpenValues& open) {
  ScrewAnswer answer;
  for (const PedicleScrew& screw : open.screws) {
    for (const double hole_mm : open.holes_mm) {
      for (const double g_cm3 : open.bones) {
        const ScrewFixation fixation = screw_fixation(
            screwed_along_z(screw, hole_mm),
            [&](std::span<const Vec3>, std::span<double> g) { std::fill(g.begin(), g.end(), g_cm3); },
            test::foam_fixation_model());
        answer.pullout.add(fixation.pullout_n.median, fixation.pullout_n);
        answer.torque.add(fixation.max_torque_n_mm.median, fixation.max_torque_n_mm);
      }
    }
  }
  return answer;
}

/// Of a row of screws.csv; nothing for those that the law is not of.
std::optional<ScrewAnswer> answer_to(const ScrewMeasurement& row) {
  const std::vector<PedicleScrew> usual{kThinScrew, kUsualScrew};
  const std::vector<double> holes_mm{3.0, 4.0};
  const auto has = [&](const char* word) { return row.group.find(word) != std::string::npos; };
  if (row.torque_kind == MeasuredTorque::extraction) return std::nullopt;  // of healed screws
  if (row.source == "weidling2022") {
    // 25 mm of thread: its flank overlap area over that of a millimetre is that, of each screw. The core is a cone
    // whose ends are not told: its mean all along.
    PedicleScrew screw{row.group, *row.outer_diameter_mm, 29.0, 4.0};
    screw.thread = ScrewThread{.core_diameter_mm = *row.core_diameter_mm, .pitch_mm = *row.pitch_mm};
    return of_foam({{screw}, {3.0, 3.5}, {*row.density_g_cm3}});
  }
  if (row.source == "bilayer_foam2018" && row.tissue == MeasuredTissue::foam) {
    if (row.site != "monolayer foam") return std::nullopt;  // the layers' densities and depths are not told
    const double g_cm3 = has("extremely") ? 0.08 : has("osteoporotic") ? 0.16 : 0.24;
    return of_foam({usual, holes_mm, {g_cm3}});
  }
  if (row.source == "bilayer_foam2018") {
    if (has("extremely")) return of_vertebra({usual, holes_mm, {50.0, 88.0}});
    if (has("osteoporotic")) return of_vertebra({usual, holes_mm, {88.0, 124.0}});
    return of_vertebra({usual, holes_mm, {160.0, 194.0}});
  }
  if (row.source == "oh_neurospine") return of_vertebra({usual, holes_mm, {*row.hu}}, true);
  if (row.source == "midline_cortical2023") {
    if (has("midline")) return std::nullopt;  // another trajectory, through cortex
    return of_vertebra({usual, holes_mm, {50.0, 106.0}});
  }
  if (row.source == "jansen2025") return of_vertebra({usual, holes_mm, {120.0, 194.0}});
  if (row.source == "eight_patients") return of_vertebra({usual, holes_mm, {88.0, 194.0}});
  if (row.source == "elderly_lumbar") return of_vertebra({usual, holes_mm, {80.0, 130.0}});
  if (row.source == "okuyama2000") {
    return of_vertebra({usual, holes_mm, has("fracture") ? std::vector{50.0, 106.0} : std::vector{88.0, 177.0}});
  }
  if (row.source == "cervical_torque2014") {
    if (row.site != "C7 pedicle") return std::nullopt;  // lateral masses: no cancellous bone to speak of
    const PedicleScrew screw{"3.5 x 26 mm", 3.5, 26.0, 3.0};
    return of_vertebra({{screw}, {2.0, 2.4}, {200.0, 300.0}});
  }
  fail("no prediction for a row of ", row.source);
}

struct ComparedScrew {
  std::string what;
  double measured = 0.0, sd = 0.0;
  PredictedRange predicted;

  bool meets() const { return predicted.low <= measured + sd && predicted.high >= measured - sd; }
  bool is_inside() const { return std::abs(predicted.middle() - measured) <= sd; }
  bool is_in_band() const { return measured >= predicted.widest.p05 && measured <= predicted.widest.p95; }
  double ratio() const { return predicted.middle() / measured; }
};

std::vector<ComparedScrew> work_out_rows() {
  std::vector<ComparedScrew> all;
  for (const ScrewMeasurement& row : shipped_measurements().screws) {
    const std::optional<ScrewAnswer> answer = answer_to(row);
    if (!answer) continue;
    const std::string name = row.source + ", " + row.site + (row.group.empty() ? "" : ", " + row.group);
    if (row.pullout_n)
      all.push_back({name + ": pull-out, N", *row.pullout_n, row.pullout_sd_n.value_or(0.0), answer->pullout});
    if (row.torque_n_mm && row.torque_kind != MeasuredTorque::extraction) {
      all.push_back({name + ": torque, N mm", *row.torque_n_mm, row.torque_sd_n_mm.value_or(0.0), answer->torque});
    }
  }
  return all;
}

const std::vector<ComparedScrew>& compared_rows() {
  static const std::vector<ComparedScrew> rows = work_out_rows();
  return rows;
}

TEST(MeasuredScrews, AreToldByALawThatKnowsNoneOfThem) {
  const std::vector<ComparedScrew>& all = compared_rows();
  std::size_t overlapping = 0, inside = 0, in_band = 0;
  std::vector<double> factors;
  std::printf(
      "measured +- sd: predicted over all that is open, its middle, that over the measured; whether they meet, "
      "whether the middle is inside, whether the measured is in the band\n");
  for (const ComparedScrew& one : all) {
    std::printf("%s: %.0f +- %.0f: %.0f to %.0f, %.0f, %.2f; %s, %s, %s\n", one.what.c_str(), one.measured, one.sd,
                one.predicted.low, one.predicted.high, one.predicted.middle(), one.ratio(),
                one.meets() ? "meet" : "apart", one.is_inside() ? "inside" : "outside",
                one.is_in_band() ? "in the band" : "out of the band");
    overlapping += one.meets() ? 1U : 0U;
    inside += one.is_inside() ? 1U : 0U;
    in_band += one.is_in_band() ? 1U : 0U;
    factors.push_back(std::exp(std::abs(std::log(one.ratio()))));
  }
  std::sort(factors.begin(), factors.end());
  const double median = factors[factors.size() / 2];
  std::printf("%zu figures: %zu meet, %zu inside, %zu in the band; factor of error: median %.2f, max %.2f\n",
              all.size(), overlapping, inside, in_band, median, factors.back());
  // What is asked of laws of forces, too: nine of ten in a band of 90 % (with so few, 85 %), and half of them told to
  // a factor of 1.6.
  EXPECT_GE(static_cast<double>(in_band), 0.85 * static_cast<double>(all.size()));
  EXPECT_LE(median, 1.6);
  EXPECT_GE(all.size(), 40u);
}

TEST(MeasuredScrews, ScrewsOfStatedSizesInFoamOfStatedDensityAreToldToTheBandsFactor) {
  for (const ComparedScrew& one : compared_rows()) {
    if (one.what.rfind("weidling2022", 0) != 0) continue;
    EXPECT_TRUE(one.is_in_band()) << one.what << ", factor " << one.ratio();
  }
}

}  // namespace
}  // namespace spinaltap

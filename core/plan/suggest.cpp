#include "core/plan/suggest.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "core/anatomy/landmarks.h"
#include "core/base/check_range.h"
#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/grading/instrument.h"
#include "core/plan/convergence.h"
#include "core/plan/detail/suggestion_words.h"
#include "core/plan/detail/trajectory_search.h"
#include "core/points/material.h"
#include "core/tool/plate.h"

namespace spinaltap {
namespace {

void check_options(std::span<const PedicleScrew> screws, const SuggestOptions& options) {
  if (screws.empty()) fail("suggesting paths: expected one screw or more");
  for (const PedicleScrew& screw : screws) check_screw(screw);
  check_bit(options.bit);
  check_turns(options.bit, "paths through pedicles");
  const auto within = [](double value, double lowest, double highest, const char* what) {
    check_range(value, lowest, highest, "suggesting paths", what);
  };
  within(options.margin_mm, 0.0, 5.0, "a margin around the screw (mm)");
  within(options.min_margin_mm, 0.0, options.margin_mm, "a least margin (mm)");
  within(options.lateral_breach_mm, 0.0, 6.0, "a lateral breach of in-out-in screws (mm)");
  within(options.max_back_out_mm, 0.0, 10.0, "a way that screws may stand out (mm)");
  within(options.front_margin_mm, 0.0, 30.0, "a margin ahead of the tip (mm)");
  within(options.widest_share, 0.1, 1.0, "a share of the pedicle's width");
  within(options.furthest_share, 0.2, 1.0, "a share of the body's depth");
  within(options.max_turn_deg, 0.0, 45.0, "a turn from the pedicle's axis (degrees)");
  const SuggestWeights& weights = options.weights;
  for (const double weight : {weights.length, weights.diameter, weights.clearance, weights.canal, weights.endplates,
                              weights.density, weights.along_axis, weights.alike, weights.approach, weights.fixation}) {
    within(weight, 0.0, 100.0, "weights");
  }
}

using detail::short_number;

/// What is tried, in order, until something of grade A is found. Margins below 0 let a screw breach: the last resort.
std::vector<detail::Attempt> attempts_of(const SuggestOptions& options, double pedicle_width_mm) {
  constexpr double kNarrowMm = 5.0;
  const auto margins = [&] {
    std::vector<double> steps{options.margin_mm};
    for (const double mm : {0.5, 0.35, 0.2, 0.1, 0.0}) {
      if (mm < options.margin_mm && mm >= options.min_margin_mm) steps.push_back(mm);
    }
    return steps;
  }();
  const int rank = level_rank(options.level);
  const bool is_known = options.level != Level::kNone;
  const bool is_lumbar = is_known && rank >= level_rank(Level::kL1) && options.level != Level::kT13;
  const bool is_thoracic = is_known && !is_lumbar && rank >= level_rank(Level::kT1);
  std::vector<detail::Attempt> attempts;
  const auto add = [&](Technique technique) {
    for (const double mm : margins) {
      // A narrow pedicle is filled more, as far as the margin lets it.
      attempts.push_back({technique, mm, mm < options.margin_mm ? 1.0 : options.widest_share});
    }
  };
  if (options.technique) {
    if (*options.technique == Technique::in_out_in) {
      attempts.push_back({Technique::in_out_in, std::min(options.margin_mm, 0.5), 1.0});
    } else {
      add(*options.technique);
    }
    return attempts;
  }
  add(Technique::pedicle);
  if (is_thoracic || (!is_known && pedicle_width_mm < kNarrowMm)) {
    attempts.push_back({Technique::in_out_in, std::clamp(0.5, options.min_margin_mm, options.margin_mm), 1.0});
  }
  if (is_lumbar) add(Technique::cortical);
  if (options.min_margin_mm > 0.0) return attempts;
  for (const double mm : {-0.5, -1.0, -1.9}) attempts.push_back({Technique::pedicle, mm, 2.0});
  return attempts;
}

/// Backs a screw out until its head neither presses deep into bone nor stands on the joint: by as little as does it, or
/// as helps most.
DrillPath with_head_clear(const WallDistance& walls, const DrillPath& path, double max_mm) {
  constexpr double kStepMm = 0.5;
  DrillPath best = path;
  double least = std::numeric_limits<double>::infinity();
  for (double out_mm = 0.0; out_mm <= max_mm + 1e-9; out_mm += kStepMm) {
    DrillPath other = path;
    other.target_mm -= out_mm * path.direction();
    const InstrumentContacts contacts =
        instrument_contacts(walls, other, opening_limit_mm(path.screw->radius_mm()), 0.0);
    double harm = 10.0 * contacts.joint_depth_mm;
    for (const Finding& finding : contacts.findings) {
      if (finding.part == InstrumentPart::head) harm += std::max(0.0, finding.depth_mm - kSeatMm);
    }
    if (harm < least - 1e-9) {
      least = harm;
      best = other;
    }
    if (harm == 0.0) break;
  }
  return best;
}

/// A candidate graded in full, with what its findings take from its score.
struct Graded {
  detail::ScrewCandidate candidate;
  detail::Attempt attempt;
  SuggestedPath path;
  double worth = 0.0;
};

/// Screws that fill less of a pedicle's width hold less than they could.
constexpr double kThin = 0.6;
/// Where less bone is left around a screw another one is better, though it be thinner: no surface is found so well.
constexpr double kTightMm = 0.25;

class SideSearch {
 public:
  SideSearch(const WallDistance& walls, const HuSampler& hu, const Material& material,
             std::span<const PedicleScrew> screws, const SuggestOptions& options, double side)
      : walls_(walls),
        hu_(hu),
        material_(material),
        screws_(screws),
        options_(options),
        side_(side),
        search_(walls, hu, screws, options, side) {}

  void run(const Progress& progress) {
    constexpr double kHalfMm = 0.5;
    for (const detail::Attempt& attempt : attempts_of(options_, search_.pedicle().width_mm)) {
      // What was found with more margin is only given up for a better one with half a millimetre still around it.
      const bool is_second_look = has_path();
      if (is_second_look && (attempt.technique != best().attempt.technique || attempt.margin_mm < kHalfMm)) break;
      for (const detail::ScrewCandidate& candidate : search_.find(attempt, kMaxRefined, progress)) {
        Graded one = grade(candidate, attempt);
        if (objection(one.path, attempt).empty()) found_.push_back(std::move(one));
      }
      std::stable_sort(found_.begin(), found_.end(), is_better);
      if (has_path() && (is_second_look || holds_well(best().path))) break;
    }
    look_for_thicker(progress);
  }

  bool has_path() const { return !found_.empty(); }
  const Graded& best() const { return found_.front(); }
  double width_mm() const { return search_.pedicle().width_mm; }

  /// The best with a screw no wider and longer than `largest`; nothing where that is not of grade A.
  std::optional<Graded> smaller(const PedicleScrew& largest) {
    const std::optional<detail::ScrewCandidate> candidate =
        search_.with_smaller(best().candidate, best().attempt, largest);
    if (!candidate) return std::nullopt;
    Graded one = grade(*candidate, best().attempt);
    if (!objection(one.path, one.attempt).empty() || one.path.grade.grade != best().path.grade.grade)
      return std::nullopt;
    return one;
  }
  void take(const Graded& other, const std::string& reason) {
    found_.insert(found_.begin(), other);
    alike_ = reason;
  }

  Suggestion suggestion() const {
    Suggestion result;
    result.side = side_ > 0.0 ? "left" : "right";
    if (!has_path()) {
      result.rejection = rejection(result.side);
      return result;
    }
    // For a rod: none that is graded worse, of which there is more to warn, or with less bone where that is little.
    for (std::size_t n = 1; n < found_.size(); ++n) {
      const SuggestedPath& other = found_[n].path;
      if (other.grade.grade == best().path.grade.grade && warnings(other) <= warnings(best().path) &&
          tight_share(other) <= tight_share(best().path)) {
        result.others.push_back(other);
        result.others.back().reasons = why_thin(found_[n]);
      }
    }
    SuggestedPath chosen = best().path;
    chosen.safe = safe_zone(walls_, chosen.path);
    chosen.trajectories_tried = search_.trajectories_tried();
    chosen.reasons = reasons();
    result.best = std::move(chosen);
    return result;
  }

 private:
  static constexpr std::size_t kMaxRefined = 6;

  /// Of a screw that is thin for its pedicle: the best ways are those that are best for thin ones, so that a thick
  /// one's may not be among them.
  void look_for_thicker(const Progress& progress) {
    if (!has_path() || !is_thin(best().path)) return;
    detail::Attempt attempt = best().attempt;
    if (attempt.technique == Technique::in_out_in || attempt.margin_mm < 0.0) return;
    attempt.least_diameter_mm = thick_mm();
    for (const detail::ScrewCandidate& candidate : search_.find(attempt, kMaxRefined, progress)) {
      Graded one = grade(candidate, attempt);
      if (objection(one.path, attempt).empty()) found_.push_back(std::move(one));
    }
    std::stable_sort(found_.begin(), found_.end(), is_better);
  }

  bool is_thin(const SuggestedPath& path) const {
    return path.path.screw->diameter_mm < kThin * search_.pedicle().width_mm;
  }

  /// 0 where there is bone enough around the screw, 1 where there is none.
  static double tight_share(const SuggestedPath& path) {
    const double least_mm = std::min(path.grade.outer.clearance_mm, path.grade.canal.clearance_mm);
    return std::clamp(1.0 - least_mm / kTightMm, 0.0, 1.0);
  }

  Graded grade(const detail::ScrewCandidate& candidate, const detail::Attempt& attempt) const {
    Graded one{candidate, attempt, {}, 0.0};
    one.path.path = with_head_clear(walls_, candidate.path, options_.max_back_out_mm);
    one.path.grade = grade_path(walls_, hu_, material_, one.path.path, options_.grade);
    one.path.score = candidate.score;
    one.path.angles = path_angles(candidate.path.direction(), walls_.landmarks().axes, side_ > 0.0);
    one.path.technique = attempt.technique;
    one.path.margin_mm = attempt.margin_mm;
    add_convergence(one.path);
    const InstrumentContacts& contacts = one.path.grade.instrument;
    const double out_mm = candidate.path.screw->length_mm - one.path.path.length_mm();
    const double screw_mm = candidate.path.screw->diameter_mm;
    const double full_mm = options_.furthest_share * walls_.landmarks().body.depth_mm;
    one.path.score += options_.weights.fixation * fixation_term(one.path);
    one.worth = one.path.score - contacts.cut_behind_mm - 2.0 * contacts.joint_depth_mm -
                0.5 * std::max(0.0, -kSeatMm - contacts.head_clearance_mm) -
                2.0 * options_.weights.length * out_mm / std::max(full_mm, 1.0) -
                2.0 * options_.weights.diameter * std::max(0.0, thick_mm() - screw_mm) / search_.pedicle().width_mm -
                0.3 * static_cast<double>(warnings(one.path)) - tight_share(one.path);
    return one;
  }

  /// 1 where the screw holds as screws of usual size do in sound vertebrae: some 1 kN in cadavers.
  static double fixation_term(const SuggestedPath& path) {
    constexpr double kSoundN = 1000.0;
    return std::min(1.0, path.grade.fixation->pullout_n.median / kSoundN);
  }

  /// A warning where a path converges as none published for its level does: then the level, the bone's planes or the
  /// path are not what they should be. Cortical trajectories run outwards.
  void add_convergence(SuggestedPath& path) const {
    const std::optional<ConvergenceRange> range = published_convergence(options_.level);
    const double deg = path.angles.convergence_deg;
    if (!range || path.technique == Technique::cortical || (deg >= range->low_deg && deg <= range->high_deg)) return;
    Finding finding{InstrumentPart::tool, VertebraPart::pedicle, 0.0, 0.0, path.path.entry_mm, true, ""};
    finding.words = "converges by " + short_number(deg) + " degrees; published for " + level_name(options_.level) +
                    " are " + short_number(range->low_deg, 0) + " to " + short_number(range->high_deg, 0) +
                    ": check the level and the bone";
    std::vector<Finding>& findings = path.grade.findings;
    const auto note =
        std::find_if(findings.begin(), findings.end(), [](const Finding& one) { return !one.is_warning; });
    findings.insert(note, finding);
  }

  /// Of the body's depth, how much the screw reaches into.
  double body_share(const SuggestedPath& path) const {
    const Landmarks& marks = walls_.landmarks();
    const double back_mm = marks.to_own(marks.body.centre_mm).y() + 0.5 * marks.body.depth_mm;
    return (back_mm - marks.to_own(path.path.target_mm).y()) / marks.body.depth_mm;
  }

  /// Screws as thick as this are thick enough for the pedicle, or the thickest there are.
  double thick_mm() const {
    double thickest_mm = 0.0;
    for (const PedicleScrew& screw : screws_) thickest_mm = std::max(thickest_mm, screw.diameter_mm);
    return std::min(thickest_mm, kThin * search_.pedicle().width_mm);
  }

  /// Thick and deep enough that nobody would look further.
  bool holds_well(const SuggestedPath& path) const {
    constexpr double kDeep = 0.5;
    return path.path.screw->diameter_mm >= thick_mm() && body_share(path) >= kDeep && tight_share(path) == 0.0;
  }

  static std::ptrdiff_t warnings(const SuggestedPath& path) {
    return std::count_if(path.grade.findings.begin(), path.grade.findings.end(),
                         [](const Finding& finding) { return finding.is_warning; });
  }

  /// What speaks against a path in its technique's sense (all in bone, or out only where that is meant), as what the
  /// screw "would" do; empty: nothing.
  std::string objection(const SuggestedPath& path, const detail::Attempt& attempt) const {
    constexpr double kLeastDeep = 0.35;  // of the body: less holds little
    const PathGrade& grade = path.grade;
    if (const double share = body_share(path); share < kLeastDeep) {
      return share > 0.0 ? "reach only " + short_number(100.0 * share, 0) + " % into the body" : "not reach the body";
    }
    if (attempt.margin_mm >= 0.0 && grade.facet > 1) return "stand in the joint";
    if (attempt.technique == Technique::in_out_in) {
      const auto beyond = [&](PathSide side) { return grade.side_breach_mm[static_cast<std::size_t>(side)] > 0.0; };
      const bool is_meant = !beyond(PathSide::medial) && !beyond(PathSide::anterior) &&
                            !(grade.canal.clearance_mm < 0.0) && grade.breach_mm <= options_.lateral_breach_mm;
      return is_meant ? "" : "stand out of bone where it is not meant to";
    }
    // The last resort puts up with a breach below 2 mm; nothing else with one.
    const Grade worst = attempt.margin_mm < 0.0 ? Grade::B : Grade::A;
    return grade.grade <= worst ? "" : std::string("be of grade ") + letter_of(grade.grade);
  }

  static bool is_better(const Graded& a, const Graded& b) {
    if (a.path.grade.grade != b.path.grade.grade) return a.path.grade.grade < b.path.grade.grade;
    return a.worth > b.worth;
  }

  std::string rejection(const std::string& side) const {
    double thinnest_mm = screws_.front().diameter_mm;
    for (const PedicleScrew& screw : screws_) thinnest_mm = std::min(thinnest_mm, screw.diameter_mm);
    const double least_mm = options_.min_margin_mm;
    return "no screw of the table keeps " + short_number(least_mm, 2) + " mm of bone around it on any straight " +
           "trajectory of " + std::to_string(search_.trajectories_tried()) + " through the " + side +
           " pedicle, which is " + short_number(search_.pedicle().width_mm, 2) + " mm wide and " +
           short_number(search_.pedicle().height_mm, 2) + " mm high; the thinnest screw has " +
           short_number(thinnest_mm, 2) + " mm";
  }

  std::vector<std::string> reasons() const {
    const SuggestedPath& chosen = best().path;
    const PedicleScrew& screw = *chosen.path.screw;
    const double width_mm = search_.pedicle().width_mm;
    std::vector<std::string> words;
    const std::string wide = "the pedicle is " + short_number(width_mm) + " mm wide";
    const detail::Attempt& attempt = best().attempt;
    if (attempt.technique == Technique::in_out_in) {
      words.push_back(wide + ", too narrow for a screw: in-out-in, between pedicle and rib, with the tip in the body");
    } else if (attempt.technique == Technique::cortical) {
      words.push_back(wide + ": a cortical trajectory, upwards and outwards from the pars");
    } else if (attempt.margin_mm < 0.0) {
      words.push_back(wide + ", narrower than the screw and its margins: the thinnest breach of its wall");
    } else if (attempt.margin_mm < options_.margin_mm) {
      words.push_back(wide + ": " + short_number(attempt.margin_mm, 2) + " mm of bone around the screw is looked for " +
                      "instead of " + short_number(options_.margin_mm, 2) + " mm");
    }
    words.push_back("fills " + short_number(100.0 * screw.diameter_mm / width_mm, 0) + " % of the pedicle's width");
    const double out_mm = screw.length_mm - chosen.path.length_mm();
    if (out_mm > 0.1) {
      words.push_back("stands " + short_number(out_mm) + " mm out of its hole so that its head is clear of the bone " +
                      "behind the entry");
    }
    if (!alike_.empty()) words.push_back(alike_);
    add_comparison(words);
    for (std::string& why : why_thin(best())) words.push_back(std::move(why));
    return words;
  }

  /// Why a screw that fills little of its pedicle is no thicker: what the next one of the table would do on its way,
  /// and what keeps it from all others. Empty of any other screw.
  std::vector<std::string> why_thin(const Graded& one) const {
    if (!is_thin(one.path)) return {};
    const PedicleScrew& screw = *one.path.path.screw;
    const PedicleScrew* next = detail::next_thicker(screws_, screw);
    if (next == nullptr) return {"the table has no thicker screw"};
    detail::ScrewCandidate candidate = one.candidate;
    candidate.path.screw = *next;
    candidate.path.target_mm += (next->length_mm - screw.length_mm) * candidate.path.direction();
    const Graded thicker = grade(candidate, one.attempt);
    const double margin_mm = std::max(0.0, one.attempt.margin_mm);
    const std::string against = objection(thicker.path, one.attempt);
    std::vector<std::string> words{detail::thicker_on_way(*next, thicker.path.grade, margin_mm, against)};
    // Where it would do, nothing keeps it out: the lattice has no way that was moved as far as this one.
    const PathGrade& graded = thicker.path.grade;
    if (against.empty() && std::min(graded.canal.clearance_mm, graded.outer.clearance_mm) >= margin_mm) return words;
    // Those beside the pedicle go by other rules, and a last resort is not looked for by margins.
    if (one.attempt.technique != Technique::in_out_in && one.attempt.margin_mm >= 0.0) {
      words.push_back(detail::limits_in_words(limits_of(one.attempt, next->diameter_mm), one.attempt));
    }
    return words;
  }

  /// Of each kind of search once: it goes over the whole lattice, and the ways to choose from share it.
  const detail::SearchLimits& limits_of(const detail::Attempt& attempt, double diameter_mm) const {
    const std::tuple key(attempt.technique, attempt.margin_mm, attempt.widest_share, diameter_mm);
    const auto [found, is_new] = limits_.try_emplace(key);
    if (is_new) found->second = search_.limits(attempt, diameter_mm);
    return found->second;
  }

  /// What the chosen one has more of than another; empty where there is nothing to tell.
  std::string gains_over(const SuggestedPath& other) const {
    const SuggestedPath& chosen = best().path;
    std::string words;
    const auto add = [&](double gain, double least, const std::string& told) {
      if (gain >= least) words += (words.empty() ? "" : ", ") + told;
    };
    const auto around_mm = [](const SuggestedPath& path) {
      return std::min(path.grade.outer.clearance_mm, path.grade.canal.clearance_mm);
    };
    const auto turned_deg = [&](const SuggestedPath& path) {
      return std::acos(std::clamp(path.path.direction().dot(search_.pedicle().axis), -1.0, 1.0)) / kDegree;
    };
    const auto sunk_mm = [](const SuggestedPath& path) {
      return std::max(0.0, -path.grade.instrument.head_clearance_mm);
    };
    const double more_mm = around_mm(chosen) - around_mm(other);
    // Half of what it is thinner by goes without saying.
    const double thinner_mm = other.path.screw->diameter_mm - chosen.path.screw->diameter_mm;
    add(more_mm - 0.5 * std::max(0.0, thinner_mm), 0.1, short_number(more_mm) + " mm more of bone around it");
    const double straighter_deg = turned_deg(other) - turned_deg(chosen);
    const std::string degrees = short_number(straighter_deg, 0);
    add(straighter_deg, 1.0, "a way " + degrees + (degrees == "1" ? " degree" : " degrees") + " straighter");
    const double shallower_mm = sunk_mm(other) - sunk_mm(chosen);
    add(shallower_mm, 0.3, "a head " + short_number(shallower_mm) + " mm less deep in bone");
    const double deeper_mm = walls_.landmarks().body.depth_mm * (body_share(chosen) - body_share(other));
    add(deeper_mm, 1.0, "a tip " + short_number(deeper_mm) + " mm deeper in the body");
    const double flatter_deg = other.grade.entry_slant_deg - chosen.grade.entry_slant_deg;
    add(flatter_deg, 5.0, "an entry " + short_number(flatter_deg, 0) + " degrees flatter");
    return words;
  }

  /// Against the first of the others with a thicker screw: what the thinner one is for.
  void add_comparison(std::vector<std::string>& words) const {
    const SuggestedPath& chosen = best().path;
    for (const Graded& other : found_) {
      const double thinner_mm = other.path.path.screw->diameter_mm - chosen.path.screw->diameter_mm;
      const std::string gains = thinner_mm > 0.0 ? gains_over(other.path) : "";
      if (gains.empty()) continue;
      words.push_back(short_number(thinner_mm) + " mm thinner than could be, for " + gains);
      return;
    }
  }

  const WallDistance& walls_;
  const HuSampler& hu_;
  const Material& material_;
  std::span<const PedicleScrew> screws_;
  const SuggestOptions& options_;
  double side_;
  detail::TrajectorySearch search_;
  std::vector<Graded> found_;                                                                     ///< best first
  mutable std::map<std::tuple<Technique, double, double, double>, detail::SearchLimits> limits_;  ///< limits_of()
  std::string alike_;
};

/// Gives both sides one size of screw where the sum of their worths falls by `weights.alike` at most, and none becomes
/// too thin for its pedicle.
void make_alike(SideSearch& left, SideSearch& right, const SuggestOptions& options) {
  if (!left.has_path() || !right.has_path()) return;
  if (left.best().attempt.technique == Technique::in_out_in || right.best().attempt.technique == Technique::in_out_in)
    return;
  const PedicleScrew& a = *left.best().path.path.screw;
  const PedicleScrew& b = *right.best().path.path.screw;
  PedicleScrew both = a;
  both.diameter_mm = std::min(a.diameter_mm, b.diameter_mm);
  both.length_mm = std::min(a.length_mm, b.length_mm);
  const auto is_alike = [&](const PedicleScrew& screw) {
    return screw.diameter_mm == both.diameter_mm && screw.length_mm == both.length_mm;
  };
  if (is_alike(a) && is_alike(b)) return;
  struct Change {
    SideSearch* side;
    std::optional<Graded> to;
  };
  std::vector<Change> changes;
  double lost = 0.0;
  for (SideSearch* side : {&left, &right}) {
    if (is_alike(*side->best().path.path.screw)) continue;
    if (both.diameter_mm < side->best().path.path.screw->diameter_mm && both.diameter_mm < kThin * side->width_mm())
      return;
    std::optional<Graded> to = side->smaller(both);
    if (!to || !is_alike(*to->path.path.screw)) return;
    lost += side->best().worth - to->worth;
    changes.push_back({side, std::move(to)});
  }
  if (lost > options.weights.alike) return;
  for (const Change& change : changes) {
    const PedicleScrew& was = *change.side->best().path.path.screw;
    change.side->take(*change.to, "could be " + short_number(was.diameter_mm) + " x " + short_number(was.length_mm, 0) +
                                      " mm; made alike the other side's");
  }
}

/// How large an error may be: the last that does no harm before the first that does, to within `max` / 1000.
template <class Harms>
double max_harmless(double max, const Harms& harms) {
  constexpr int kSteps = 12;
  double harmless = 0.0;
  double harmful = max;
  for (int step = 1; step <= kSteps; ++step) {
    const double error = max * step / kSteps;
    if (harms(error)) {
      harmful = error;
      break;
    }
    harmless = error;
  }
  while (harmful - harmless > 1e-3 * max) {
    const double middle = 0.5 * (harmless + harmful);
    (harms(middle) ? harmful : harmless) = middle;
  }
  return harmless;
}

}  // namespace

const std::map<std::string, Technique>& techniques() {
  static const std::map<std::string, Technique> names{
      {"pedicle", Technique::pedicle}, {"in-out-in", Technique::in_out_in}, {"cortical", Technique::cortical}};
  return names;
}

const std::string& name_of(Technique technique) {
  for (const auto& [name, known] : techniques()) {
    if (known == technique) return name;
  }
  fail_as(ErrorKind::internal, "no such technique");
}

const std::map<std::string, SagittalReference>& sagittal_references() {
  static const std::map<std::string, SagittalReference> names{
      {"anatomic", SagittalReference::anatomic}, {"straight-forward", SagittalReference::straight_forward}};
  return names;
}

std::vector<Suggestion> suggest_paths(const WallDistance& walls, const HuSampler& hu, const Material& material,
                                      std::span<const PedicleScrew> screws, const SuggestOptions& options,
                                      const Progress& progress) {
  check_options(screws, options);
  SideSearch left(walls, hu, material, screws, options, 1.0);
  SideSearch right(walls, hu, material, screws, options, -1.0);
  tbb::parallel_invoke([&] { left.run(progress); }, [&] { right.run(progress); });
  make_alike(left, right, options);
  std::vector<Suggestion> sides(2);
  tbb::parallel_invoke([&] { sides[0] = left.suggestion(); }, [&] { sides[1] = right.suggestion(); });
  return sides;
}

SafeZone safe_zone(const WallDistance& walls, const DrillPath& path) {
  check_straight(path, "a safe zone");
  constexpr double kMaxMm = 8.0;
  constexpr double kMaxDeg = 24.0;
  // Rings of the screw half a millimetre apart: a wall is met at most that late.
  const GradeOptions coarse{.step_mm = 0.5};
  const auto breaches = [&](const DrillPath& other) { return breach_mm(walls, other, coarse) > 0.0; };
  if (breaches(path)) return {};
  const Landmarks& marks = walls.landmarks();
  const Vec3 direction = path.direction();
  const double side = marks.to_own(path.entry_mm).x() > 0.0 ? 1.0 : -1.0;
  const Vec3 medial = (Mat3::Identity() - direction * direction.transpose()) * (-side * marks.left());
  const Vec3 medial_unit = medial.normalized();
  Vec3 cranial = direction.cross(medial_unit);
  if (cranial.dot(marks.superior()) < 0.0) cranial = -cranial;
  const auto shift_mm = [&](const Vec3& to) {
    return max_harmless(kMaxMm, [&](double mm) {
      DrillPath other = path;
      other.entry_mm += mm * to;
      other.target_mm += mm * to;
      return breaches(other);
    });
  };
  const auto turn_deg = [&](const Vec3& to) {
    return max_harmless(kMaxDeg, [&](double degrees) {
      DrillPath other = path;
      const double angle = degrees * kDegree;
      other.target_mm = path.entry_mm + path.length_mm() * (std::cos(angle) * direction + std::sin(angle) * to);
      return breaches(other);
    });
  };
  SafeZone zone;
  const std::array<std::pair<double*, Vec3>, 4> shifts{{{&zone.medial_mm, medial_unit},
                                                        {&zone.lateral_mm, -medial_unit},
                                                        {&zone.cranial_mm, cranial},
                                                        {&zone.caudal_mm, -cranial}}};
  const std::array<double*, 4> turns{&zone.medial_deg, &zone.lateral_deg, &zone.cranial_deg, &zone.caudal_deg};
  tbb::parallel_for(std::size_t{0}, 2 * shifts.size(), [&](std::size_t n) {
    const auto& [shift, to] = shifts[n / 2];
    (n % 2 == 0 ? *shift : *turns[n / 2]) = n % 2 == 0 ? shift_mm(to) : turn_deg(to);
  });
  return zone;
}

std::vector<DrillPath> paths_of(const std::vector<Suggestion>& suggestions) {
  std::vector<DrillPath> paths;
  std::string rejections;
  for (const Suggestion& suggestion : suggestions) {
    if (suggestion.best) {
      paths.push_back(suggestion.best->path);
    } else {
      rejections += (rejections.empty() ? "" : "; ") + suggestion.rejection;
    }
  }
  if (paths.empty()) fail("no path to suggest: ", rejections);
  return paths;
}

}  // namespace spinaltap

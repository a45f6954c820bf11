#include "core/phantom/random_trunk.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/phantom/spine.h"

namespace spinaltap {
namespace {

/// A row of random numbers; each is taken whether it is used or not, so that choices do not shift each other.
class TrunkDice {
 public:
  explicit TrunkDice(std::uint64_t seed) : seed_(mix_bits(seed ^ 0x7472756e6bULL)) {}
  double within(double low, double high) { return low + (high - low) * random_uniform(seed_, count_++); }
  bool chance(double share) { return within(0.0, 1.0) < share; }
  int pick(int low, int high) { return std::min(high, low + static_cast<int>(within(0.0, high - low + 1.0))); }
  std::uint64_t seed() const { return seed_; }

 private:
  std::uint64_t seed_, count_ = 0;
};

/// All levels that a patient has, from C1 to the last lumbar one.
std::vector<Level> all_levels(const SpineOptions& options) {
  std::vector<Level> levels;
  for (Level level = Level::kC1; level != Level::kSacrum; level = level_below(level, options)) levels.push_back(level);
  return levels;
}

/// The levels whose middles are in view.
struct View {
  int top, bottom;  ///< indices of all_levels()
  bool sacrum;
};

View random_view(TrunkDice& dice, int count) {
  constexpr int kC3 = 2, kC7 = 6, kT1 = 7, kT12 = 18;
  const bool neck = dice.chance(0.25), is_short = dice.chance(0.6), low = dice.chance(0.5);
  const int neck_top = dice.pick(kC3, kC7), neck_bottom = dice.pick(kT1 + 1, kT1 + 5);
  const int trunk_top = dice.pick(kT1, kT12 - 1), length = dice.pick(5, 14);
  const int last = count - 1;
  if (neck && is_short) return {neck_top, neck_bottom, false};
  const int top = neck ? neck_top : trunk_top;
  const int bottom = low ? last : std::min(last, top + length);
  return {top, bottom, bottom == last};
}

/// What ails the patient, beyond what random_spine_options() gives; `mildness` 0 to 1 takes from it.
void add_sicknesses(TrunkDice& dice, const std::vector<Level>& seen, double mildness, SpineOptions& options) {
  const bool crushed = dice.chance(0.31);  // necks are not crushed: a quarter of all
  const int crushes = dice.chance(0.65) ? 1 : dice.pick(2, 3);
  const int last = static_cast<int>(seen.size()) - 1;
  for (int n = 0; n < 3; ++n) {
    CrushedLevel one;
    one.level = seen[static_cast<std::size_t>(dice.pick(0, last))];
    one.front_share = dice.within(0.3, 0.75);
    one.back_share = dice.chance(0.3) ? dice.within(0.6, 0.85) : dice.within(0.85, 1.0);
    one.front_share += mildness * (1.0 - one.front_share);
    one.back_share += mildness * (1.0 - one.back_share);
    const auto same = [&](const CrushedLevel& other) { return other.level == one.level; };
    // Necks break otherwise.
    const bool fits = crushed && n < crushes && level_rank(one.level) >= level_rank(Level{10});
    if (fits && std::none_of(options.crushed.begin(), options.crushed.end(), same)) options.crushed.push_back(one);
  }
  const bool metal = dice.chance(0.08), cement = dice.chance(0.07);
  const int first = dice.pick(0, last), levels = dice.pick(1, 4);
  const double diameter = dice.within(4.5, 7.0);
  for (int n = first; metal && n <= std::min(last, first + levels); ++n) {
    const Level level = seen[static_cast<std::size_t>(n)];
    if (level_rank(level) >= level_rank(Level::kT1)) options.screws.push_back(level);
  }
  options.screw_diameter_mm = diameter;
  const Level filled = seen[static_cast<std::size_t>(dice.pick(0, last))];
  if (cement && level_rank(filled) >= level_rank(Level{10})) options.cement.push_back(filled);
}

TrunkTissueOptions random_tissue(TrunkDice& dice, const SpineOptions& spine) {
  TrunkTissueOptions tissue;
  tissue.soft.seed = dice.seed();
  tissue.soft.muscle_hu = dice.within(35.0, 65.0);
  tissue.soft.fat_hu = dice.within(-115.0, -90.0);
  tissue.soft.disc_hu = dice.within(65.0, 110.0);
  tissue.soft.skin_mm = dice.within(20.0, 60.0);
  const bool contrast = dice.chance(0.5), late = dice.chance(0.2);
  const double aorta_hu = dice.within(130.0, 380.0), kidney_hu = dice.within(120.0, 220.0);
  const double urine_hu = dice.within(300.0, 1500.0);
  tissue.soft.aorta_hu = contrast ? aorta_hu : kBloodHu;
  tissue.kidney_hu = contrast ? kidney_hu : 33.0;
  tissue.pelvis_of_kidney_hu = contrast && late ? urine_hu : 10.0;
  tissue.half_width_mm = spine.scale * dice.within(155.0, 195.0);
  tissue.front_mm = spine.scale * dice.within(145.0, 200.0);
  tissue.shoulder_mm = spine.shoulders ? kShoulderMm : 0.0;
  tissue.gas_share = dice.chance(0.75) ? dice.within(0.1, 1.0) : 0.0;
  tissue.table = dice.chance(0.85);
  tissue.stent = dice.chance(0.04);
  tissue.pacemaker = dice.chance(0.05);
  return tissue;
}

ScanOptions random_scanner(TrunkDice& dice) {
  ScanOptions scan;
  const double fine = dice.within(0.5, 1.0), usual = dice.within(1.0, 3.0), thick = dice.within(3.0, 5.0);
  const double kind = dice.within(0.0, 1.0);
  scan.slice_step_mm = kind < 0.12 ? fine : kind < 0.78 ? usual : thick;
  // Steps of a protocol: 0.1 mm.
  scan.slice_step_mm = 0.1 * std::round(10.0 * scan.slice_step_mm);
  scan.slice_width_mm = scan.slice_step_mm * (dice.chance(0.3) ? dice.within(1.0, 1.6) : 1.0);
  scan.pixel_mm = std::max(dice.within(0.6, 0.98), scan.slice_step_mm < 1.0 ? 0.7 : 0.0);
  // The softest body kernels pass half of 2.5 line pairs a cm: a Gaussian of 0.75 mm.
  const double sharpness = dice.within(0.5, 3.0), blur = dice.within(0.4, 0.75);
  const bool is_sharp = dice.chance(0.4);
  scan.sharpness = is_sharp ? sharpness : 0.0;
  scan.blur_mm = is_sharp ? 0.7 * blur : blur;
  const double noise = dice.within(16.0, 55.0), low_dose = dice.within(55.0, 120.0);
  scan.noise_hu = (dice.chance(0.2) ? low_dose : noise) * (is_sharp ? 1.3 : 1.0);
  scan.seed = dice.seed();
  scan.samples_per_pixel = 1;
  // Thick slices average over what they hold, as a scanner's do.
  scan.samples_per_step = std::max(1, static_cast<int>(std::ceil(scan.slice_step_mm / 1.3)));
  return scan;
}

/// One draw, which may be none that a Spine can be made of.
TrunkOptions draw_trunk(std::uint64_t seed, double mildness) {
  TrunkDice dice(seed);
  SpineOptions range;
  const double counts = dice.within(0.0, 1.0);
  range.thoracic_levels = counts < 0.025 ? 11 : counts < 0.05 ? 13 : 12;
  range.lumbar_levels = counts > 0.97 ? 4 : counts > 0.94 ? 6 : 5;
  const std::vector<Level> levels = all_levels(range);
  const int last = static_cast<int>(levels.size()) - 1;
  const View view = random_view(dice, last + 1);
  // Levels beyond the view, which cuts them or not.
  constexpr int kBeyond = 2;
  range.first = levels[static_cast<std::size_t>(std::max(0, view.top - kBeyond))];
  range.last = levels[static_cast<std::size_t>(std::min(last, view.bottom + kBeyond))];
  TrunkOptions trunk;
  trunk.spine = random_spine_options(dice.seed(), range);
  SpineOptions& spine = trunk.spine;
  const bool arms_down = dice.chance(0.6);
  const double lordosis = dice.within(5.0, 38.0), gentle = dice.within(-5.0, 5.0);
  spine.cervical_lordosis_deg = lordosis;
  spine.density = dice.within(0.6, 1.7);
  spine.sacrum = view.bottom + kBeyond >= last;
  spine.pelvis = spine.sacrum;
  const int t2 = level_rank(Level{9});
  spine.shoulders = arms_down && level_rank(spine.first) <= t2 && level_rank(spine.last) >= t2;
  spine.skull = spine.first == Level::kC1;
  // Patients lie straighter than random_spine_options() has them, and fewer are bent.
  if (dice.chance(0.5)) spine.scoliosis_deg *= 0.3;
  for (int axis = 0; axis < 3; ++axis) spine.tilt_deg[axis] *= 0.6;
  if (mildness > 0.0) {
    spine.tilt_deg[0] = gentle;
    spine.variation = 1.0 - 0.5 * mildness;
    spine.facet_gap_mm = std::min(spine.facet_gap_mm, 1.0);
    spine.scoliosis_deg *= 1.0 - mildness;
    if (mildness > 0.5) spine.cervical_disc_mm = spine.thoracic_disc_mm = spine.lumbar_disc_mm = std::nullopt;
  }
  const std::vector<Level> seen(levels.begin() + view.top, levels.begin() + view.bottom + 1);
  add_sicknesses(dice, seen, mildness, spine);
  trunk.tissue = random_tissue(dice, spine);
  trunk.scan = random_scanner(dice);

  // The field of view: from within the level above the first one to within the one below the last.
  const Spine made(spine);
  const auto place_of = [&](Level level) {
    const PlacedLevel* const found = placed_level(made.placed(), level);
    if (found == nullptr) fail("trunk: ", level_name(level), " is not among the levels");
    return found->position_mm;
  };
  Box3 view_mm;
  view_mm.extend(place_of(seen.front()) + Vec3(0.0, 0.0, dice.within(4.0, 32.0)));
  view_mm.extend(place_of(view.sacrum ? Level::kSacrum : seen.back()) -
                 Vec3(0.0, 0.0, dice.within(4.0, view.sacrum ? 110.0 : 32.0)));
  for (const Level level : seen) view_mm.extend(place_of(level));
  const bool whole_body = dice.chance(0.55);
  const double half = dice.within(75.0, 115.0), wide = dice.within(150.0, 195.0), off = dice.within(-12.0, 12.0);
  const double back = dice.within(70.0, 110.0), front = dice.within(55.0, 95.0), far_front = dice.within(110.0, 170.0);
  view_mm.min() -= Vec3(whole_body ? wide - off : half - off, whole_body ? far_front : front, 0.0);
  view_mm.max() += Vec3(whole_body ? wide + off : half + off, whole_body ? back + 30.0 : back, 0.0);
  // Large views are not scanned in the finest voxels.
  constexpr double kMaxVoxels = 2.6e7;
  ScanOptions& scan = trunk.scan;
  while (view_mm.volume() / (scan.pixel_mm * scan.pixel_mm * scan.slice_step_mm) > kMaxVoxels) {
    if (scan.slice_step_mm < 1.4) {
      scan.slice_width_mm *= 1.25;
      scan.slice_step_mm *= 1.25;
    } else {
      scan.pixel_mm *= 1.05;
    }
  }
  scan = scan_of_box(view_mm, scan);
  return trunk;
}

}  // namespace

TrunkOptions random_trunk_options(std::uint64_t seed) {
  constexpr int kTries = 12;
  for (int attempt = 0;; ++attempt) {
    try {
      // The first ones as they fall, then milder ones.
      return draw_trunk(seed + (static_cast<std::uint64_t>(attempt) << 40), std::max(0.0, 0.125 * (attempt - 4)));
    } catch (const Error&) {  // a cut reaches a pedicle
      if (attempt + 1 == kTries) throw;
    }
  }
}

std::string describe(const TrunkOptions& options) {
  std::ostringstream text;
  text.precision(2);
  const SpineOptions& spine = options.spine;
  const ScanOptions& scan = options.scan;
  text << scan.pixel_mm << " x " << scan.slice_step_mm << " mm, noise " << std::lround(scan.noise_hu) << " HU";
  if (scan.sharpness > 0.0) text << ", sharpness " << scan.sharpness;
  if (std::fabs(spine.scoliosis_deg) > 10.0) text << ", scoliosis " << std::lround(spine.scoliosis_deg);
  if (spine.osteoporosis) text << ", weak bone";
  if (spine.osteophyte_mm > 0.0) text << (spine.osteophyte_gap_mm < 0.5 ? ", bridging spurs" : ", spurs");
  if (spine.thoracic_disc_mm) text << ", worn discs";
  if (spine.thoracic_levels != 12) text << ", " << spine.thoracic_levels << " thoracic";
  if (spine.lumbar_levels != 5) text << ", " << spine.lumbar_levels << " lumbar";
  for (const CrushedLevel& one : spine.crushed) {
    text << ", crushed " << level_name(one.level) << " " << one.front_share << "/" << one.back_share;
  }
  for (const Level level : spine.screws) text << ", screws " << level_name(level);
  for (const Level level : spine.cement) text << ", cement " << level_name(level);
  if (options.tissue.stent) text << ", stent";
  if (options.tissue.pacemaker) text << ", pacemaker";
  return text.str();
}

}  // namespace spinaltap

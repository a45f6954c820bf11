#include "core/phantom/spine_options.h"

#include <cmath>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/phantom/detail/check_within.h"
#include "core/phantom/level_measures.h"

namespace spinaltap {
namespace {

void in_bounds(const char* name, double value, double low, double high) {
  check_within("spine phantom", name, value, low, high);
}

void among_the_levels(const char* name, Level level, const SpineOptions& options) {
  if (level_rank(level) < level_rank(options.first) || level_rank(level) > level_rank(options.last)) {
    fail("spine phantom: ", name, " must lie from ", level_name(options.first), " to ", level_name(options.last),
         ", found ", level_name(level));
  }
}

/// The last of a region's levels, of as many as there are.
Level last_thoracic(const SpineOptions& options) {
  return options.thoracic_levels == 11 ? Level{18} : options.thoracic_levels == 13 ? Level::kT13 : Level::kT12;
}
Level last_lumbar(const SpineOptions& options) {
  return static_cast<Level>(static_cast<int>(Level::kL1) + options.lumbar_levels - 1);
}

/// An end of the spine must be a level that has measures and that this patient has.
void check_end(const char* name, Level level, const SpineOptions& options) {
  const bool is_extra = level == Level::kT13 || level == Level::kL6;
  if (!is_extra) (void)level_measures(level);
  const bool lacks =
      level_rank(level) > level_rank(last_thoracic(options)) && level_rank(level) < level_rank(Level::kL1);
  if (lacks || level_rank(level) > level_rank(last_lumbar(options))) {
    fail("spine phantom: ", name, " is ", level_name(level), ", which a spine with ", options.thoracic_levels,
         " thoracic and ", options.lumbar_levels, " lumbar levels does not have");
  }
}

void check_bones_around(const SpineOptions& options) {
  if (options.sacrum && options.last != last_lumbar(options)) {
    fail("spine phantom: a sacrum needs ", level_name(last_lumbar(options)), " as the last level, found ",
         level_name(options.last));
  }
  if (options.pelvis && !options.sacrum) fail("spine phantom: a pelvis needs a sacrum");
  const int t2 = level_rank(Level{9});
  if (options.shoulders && (level_rank(options.first) > t2 || level_rank(options.last) < t2)) {
    fail("spine phantom: shoulders need T2 among the levels, found ", level_name(options.first), " to ",
         level_name(options.last));
  }
  if (options.skull && options.first != Level::kC1) {
    fail("spine phantom: a skull needs C1 as the first level, found ", level_name(options.first));
  }
}

}  // namespace

Level level_below(Level level, const SpineOptions& options) {
  if (level == last_thoracic(options)) return Level::kL1;
  if (level == last_lumbar(options)) return Level::kSacrum;
  if (level == Level::kT12) return Level::kT13;
  if (level == Level::kL5) return Level::kL6;
  return level_below(level);
}

void check_spine_options(const SpineOptions& options) {
  in_bounds("thoracic_levels", options.thoracic_levels, 11, 13);
  in_bounds("lumbar_levels", options.lumbar_levels, 4, 6);
  if (!is_upper_neck(options.first)) check_end("first", options.first, options);
  check_end("last", options.last, options);
  if (level_rank(options.first) > level_rank(options.last)) {
    fail("spine phantom: first must lie above last, found ", level_name(options.first), " and ",
         level_name(options.last));
  }
  in_bounds("scale", options.scale, 0.8, 1.25);
  if (options.cervical_disc_mm) in_bounds("cervical_disc_mm", *options.cervical_disc_mm, 0.3, 20.0);
  if (options.thoracic_disc_mm) in_bounds("thoracic_disc_mm", *options.thoracic_disc_mm, 0.3, 20.0);
  if (options.lumbar_disc_mm) in_bounds("lumbar_disc_mm", *options.lumbar_disc_mm, 0.3, 25.0);
  in_bounds("facet_gap_mm", options.facet_gap_mm, 0.0, 4.0);
  in_bounds("cervical_lordosis_deg", options.cervical_lordosis_deg, -20.0, 60.0);
  in_bounds("kyphosis_deg", options.kyphosis_deg, 0.0, 80.0);
  in_bounds("lordosis_deg", options.lordosis_deg, 0.0, 80.0);
  in_bounds("scoliosis_deg", options.scoliosis_deg, -70.0, 70.0);
  in_bounds("scoliosis_turn", options.scoliosis_turn, 0.0, 0.6);
  if (options.scoliosis_first) among_the_levels("scoliosis_first", *options.scoliosis_first, options);
  if (options.scoliosis_last) among_the_levels("scoliosis_last", *options.scoliosis_last, options);
  in_bounds("rib_gap_mm", options.rib_gap_mm, 0.0, 4.0);
  in_bounds("rib12_mm", options.rib12_mm, 20.0, 200.0);
  check_bones_around(options);
  in_bounds("osteophyte_mm", options.osteophyte_mm, 0.0, 12.0);
  in_bounds("osteophyte_gap_mm", options.osteophyte_gap_mm, 0.0, 10.0);
  in_bounds("osteophyte_share", options.osteophyte_share, 0.0, 1.0);
  in_bounds("density", options.density, 0.2, 3.0);
  for (const Level level : options.schmorl_nodes) among_the_levels("schmorl_nodes", level, options);
  for (const Level level : options.screws) among_the_levels("screws", level, options);
  for (const Level level : options.cement) among_the_levels("cement", level, options);
  for (const CrushedLevel& one : options.crushed) {
    among_the_levels("crushed", one.level, options);
    in_bounds("crushed.front_share", one.front_share, 0.25, 1.0);
    in_bounds("crushed.back_share", one.back_share, 0.5, 1.0);
  }
  in_bounds("screw_diameter_mm", options.screw_diameter_mm, 2.0, 10.0);
  in_bounds("variation", options.variation, 0.0, 1.5);
  for (int axis = 0; axis < 3; ++axis) {
    in_bounds("tilt_deg", options.tilt_deg[axis], -60.0, 60.0);
    in_bounds("position_mm", options.position_mm[axis], -1e5, 1e5);
  }
}

SpineOptions random_spine_options(std::uint64_t seed, const SpineOptions& range) {
  SpineOptions options = range;
  const std::uint64_t stream = mix_bits(seed);
  std::uint64_t count = 0;
  const auto within = [&](double low, double high) { return low + (high - low) * random_uniform(stream, count++); };
  const auto chance = [&](double share) { return within(0.0, 1.0) < share; };
  options.seed = stream;
  options.variation = 1.0;
  options.scale = within(0.85, 1.1);
  options.facet_gap_mm = within(0.5, 1.8);
  options.kyphosis_deg = within(20.0, 55.0);
  options.lordosis_deg = within(30.0, 65.0);
  const double cobb = within(-30.0, 30.0), few = within(-6.0, 6.0);
  options.scoliosis_deg = chance(0.4) ? cobb : few;
  const double narrow = within(0.4, 0.8);
  if (chance(0.25)) {  // worn discs
    options.thoracic_disc_mm = 4.0 * narrow;
    options.lumbar_disc_mm = 8.0 * narrow;
  }
  options.rib_gap_mm = within(0.5, 1.5);
  options.rib12_mm = within(30.0, 120.0);
  const double spur = within(2.0, 4.5), gap = within(0.0, 3.0);
  if (chance(0.4)) {
    options.osteophyte_mm = spur;
    options.osteophyte_gap_mm = gap;
  }
  options.osteoporosis = chance(0.3);
  for (Level level = options.first;; level = level_below(level, options)) {
    if (chance(0.1)) options.schmorl_nodes.push_back(level);
    if (level == options.last) break;
  }
  for (int axis = 0; axis < 3; ++axis) options.tilt_deg[axis] = within(-10.0, 10.0);
  return options;
}

}  // namespace spinaltap

#include "core/segment/segment_spine.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/segment/cut_levels.h"
#include "core/segment/level_names.h"
#include "core/segment/mask_shape.h"
#include "core/segment/masked_ct.h"
#include "core/segment/row_gaps.h"

namespace spinaltap {
namespace {

std::string in_words(const Vec3& p_mm) { return joined('(', p_mm.x(), ", ", p_mm.y(), ", ", p_mm.z(), ") mm"); }

/// The box around the middles of a grid's outermost voxels, patient LPS, mm.
Box3 reach_of(const GridGeometry& geometry) {
  Box3 reach(geometry.origin_mm, geometry.origin_mm);
  const Vec3 last(geometry.size[0] - 1, geometry.size[1] - 1, geometry.size[2] - 1);
  for (int corner = 0; corner < 8; ++corner) {
    reach.extend(geometry.to_patient(last.cwiseProduct(Vec3(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1))));
  }
  return reach;
}

/// Rejects a point outside the CT or in air. `what` begins the message.
void check_point(const CtVolume& ct, const std::string& what, const Vec3& p_mm) {
  if (!p_mm.allFinite()) fail(what, ": expected a position in mm, found one that is not a number");
  const GridGeometry& geometry = ct.geometry;
  const Vec3 p = geometry.to_index(p_mm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = p[static_cast<Eigen::Index>(axis)];
    if (at >= -0.5 && at <= geometry.size[axis] - 0.5) continue;
    const Box3 reach = reach_of(geometry);
    fail(what, ": expected a point in the CT, from ", in_words(reach.min()), " to ", in_words(reach.max()), ", found ",
         in_words(p_mm));
  }
  constexpr double kAirHu = -300.0;
  const double hu = sample_hu(ct, p_mm, 0.0);
  if (hu < kAirHu) {
    fail(what, ": expected a point in a vertebral body, found air (", std::lround(hu), " HU) at ", in_words(p_mm));
  }
}

/// The body that a point lies in. Throws Error, which says where the nearest one is.
std::size_t body_of(const SpineBodies& spine, const std::string& what, const Vec3& p_mm) {
  if (const auto found = body_at(spine, p_mm)) return *found;
  const VertebralBody* nearest = nullptr;
  double min_mm = std::numeric_limits<double>::infinity();
  for (const VertebralBody& body : spine.bodies) {
    const double away_mm = -body.surface.depth_mm(p_mm);
    if (away_mm >= min_mm) continue;
    min_mm = away_mm;
    nearest = &body;
  }
  if (nearest == nullptr) {
    fail_as(ErrorKind::geometry, what, ": expected a point in a vertebral body, found no spine around ",
            in_words(p_mm));
  }
  fail_as(ErrorKind::geometry, what, ": expected a point in a vertebral body, found no body's wall around ",
          in_words(p_mm), "; the nearest body begins ", std::lround(min_mm), " mm away, its middle is ",
          in_words((10.0 * nearest->cylinder.centre_mm).array().round().matrix() / 10.0));
}

/// Where a spine was looked for, and how far that went.
std::string what_was_seen(const CtVolume& ct, const SpineBodies& spine) {
  const Box3 reach = reach_of(ct.geometry);
  TextWriter text;
  text << "looked from z " << std::lround(reach.min().z()) << " to " << std::lround(reach.max().z())
       << " mm, bone from " << std::lround(spine.levels.low_hu) << " HU on; saw ";
  if (spine.canal.points_mm.empty()) {
    text << "no canal with bone on most sides and a body's depth of it in front";
  } else {
    text << "what may be a canal from z " << std::lround(spine.canal.points_mm.front().z()) << " to "
         << std::lround(spine.canal.points_mm.back().z()) << " mm, and no row of bodies in front of it";
  }
  return text.str();
}

void check_points(const CtVolume& ct, const SegmentOptions& options) {
  if (options.seed_mm) check_point(ct, "seed", *options.seed_mm);
  for (const LevelPoint& name : options.names) check_point(ct, level_name(name.level), name.p_mm);
}

/// The bodies of the CT; where they do not hold the seed, those of the spine nearest to it.
SpineBodies bodies_for(const CtVolume& ct, const SegmentOptions& options, const Progress& progress) {
  // Without the seed first: where it finds the same bodies, the seed's place changes nothing.
  SpineBodies spine = find_spine_bodies(ct, options.threshold_hu, std::nullopt, progress);
  const bool has_seed = options.seed_mm || !options.names.empty();
  const Vec3 seed_mm = options.seed_mm ? *options.seed_mm : has_seed ? options.names.front().p_mm : Vec3::Zero();
  if (has_seed && !body_at(spine, seed_mm)) {
    spine = find_spine_bodies(ct, options.threshold_hu, seed_mm, progress);
  }
  if (spine.bodies.empty()) {
    if (has_seed) body_of(spine, "seed", seed_mm);
    fail_as(ErrorKind::geometry, "found no spine in the CT: ", what_was_seen(ct, spine),
            "; give a point in a body, or the CT number from which on there is bone, and check that its slices stand "
            "across the patient and are at most some 5 mm apart");
  }
  return spine;
}

/// Names of the bodies of a chain, from below.
struct Names {
  LevelNames found;
  NameSource source = NameSource::counted;

  const std::vector<Level>& levels() const { return found.levels; }
};

Names given_names(const SpineBodies& spine, const std::vector<LevelPoint>& given) {
  std::vector<Level> levels(spine.bodies.size(), Level::kNone);
  for (const LevelPoint& one : given) {
    const std::size_t index = body_of(spine, level_name(one.level), one.p_mm);
    const std::vector<Level> counted = levels_counted_from(spine, index, one.level);
    // Beyond a gap of the row each word may know what the other does not.
    if (levels[index] != Level::kNone && levels[index] != one.level) {
      fail(level_name(one.level), ": expected a point that agrees with ", level_name(given[0].level),
           "; counted from there it lies in ", level_name(levels[index]));
    }
    for (std::size_t body = 0; body < counted.size(); ++body) {
      if (counted[body] != Level::kNone) levels[body] = counted[body];
    }
  }
  return {{std::move(levels), std::vector<std::vector<LevelProbability>>(spine.bodies.size()), {}}, NameSource::given};
}

Ribs ribs_of(const CutVertebra& cut) {
  constexpr double kMinMm3 = 60.0;
  const int sides = (cut.left_rib_mm3 > kMinMm3 ? 1 : 0) + (cut.right_rib_mm3 > kMinMm3 ? 1 : 0);
  return sides == 0 ? Ribs::none : sides == 1 ? Ribs::one_side : Ribs::both;
}

/// The names that the user gave, or those that the votes of what is seen give. `ribs`: of each body.
Names names_of(const SpineBodies& spine, const SegmentOptions& options, const std::vector<Ribs>& ribs) {
  if (!options.names.empty()) return given_names(spine, options.names);
  return {voted_names(spine, ribs), NameSource::hint};
}

std::vector<Ribs> unknown_ribs(const SpineBodies& spine) {
  return std::vector<Ribs>(spine.bodies.size(), Ribs::unknown);
}

/// The user's corrections as voxels of the CT.
std::vector<MarkedVoxels> marks_of(const CtVolume& ct, const std::vector<Correction>& corrections,
                                   const std::vector<Level>& levels) {
  constexpr double kReachMm = 3.5;  // around the point: a smaller marker has little to say in a walk through a bone
  std::vector<MarkedVoxels> marks;
  for (const Correction& correction : corrections) {
    const std::string what = correction.level == Level::kNone ? "exclude" : "include " + level_name(correction.level);
    check_point(ct, what, correction.p_mm);
    MarkedVoxels marked;
    if (correction.level != Level::kNone) {
      const auto found = std::find(levels.begin(), levels.end(), correction.level);
      if (found == levels.end()) fail(what, ": that level was not found in the CT, or has another name");
      marked.body = static_cast<std::size_t>(found - levels.begin());
    }
    const Vec3 p = ct.geometry.to_index(correction.p_mm);
    const Vec3 reach = (Vec3::Constant(kReachMm).cwiseQuotient(ct.geometry.spacing_mm)).cwiseMax(0.5);
    const auto low = (p - reach).array().ceil().cast<int>();
    const auto high = (p + reach).array().floor().cast<int>();
    for (int k = low.z(); k <= high.z(); ++k) {
      for (int j = low.y(); j <= high.y(); ++j) {
        for (int i = low.x(); i <= high.x(); ++i) {
          const Vec3 away_mm = (Vec3(i, j, k) - p).cwiseProduct(ct.geometry.spacing_mm);
          if (away_mm.norm() > kReachMm && away_mm.cwiseAbs().maxCoeff() > 0.5 * ct.geometry.spacing_mm.maxCoeff())
            continue;
          if (ct.geometry.contains(i, j, k)) marked.offsets.push_back(ct.geometry.offset(i, j, k));
        }
      }
    }
    marks.push_back(std::move(marked));
  }
  return marks;
}

/// Calls `visit(offset in the CT, voxel of the box)` for the voxels of a box.
template <class Visit>
void for_box(const GridGeometry& ct, const VoxelBox& box, const Visit& visit) {
  std::size_t voxel = 0;
  for (int k = box.low[2]; k <= box.high[2]; ++k) {
    for (int j = box.low[1]; j <= box.high[1]; ++j) {
      for (int i = box.low[0]; i <= box.high[0]; ++i) visit(ct.offset(i, j, k), voxel++);
    }
  }
}

LevelReport report_of(const CtVolume& ct, const SpineBodies& spine, const CutVertebra& cut) {
  LevelReport report;
  const BodyInRow row{spine.bodies, spine.canal, cut.index, spine.has_sacrum};
  const BodyCylinder& body = row.body().cylinder;
  report.body_centre_mm = body.centre_mm;
  report.body_size_mm = 2.0 * body.half_mm;
  report.body_axes = body.axes();
  report.body_fit = body.fit;
  report.cut_area_mm2 = cut.cut_area_mm2;
  report.parts_dropped = cut.parts_dropped;
  const auto voxels = std::count(cut.inside.begin(), cut.inside.end(), std::uint8_t{1});
  report.volume_mm3 = static_cast<double>(voxels) * ct.geometry.spacing_mm.prod();
  report.is_cut = spine.chain[cut.index].is_cut();
  report.figures = cut.figures;
  report.reaches_border = find_border(ct.geometry, cut.box, cut.inside, row, report.figures);
  report.warnings = check_level(report.figures, spine.chain, row);
  // That its arch may lack a part, check_level() tells.
  const MaskShape shape = measure_shape({crop_geometry(ct.geometry, cut.box), cut.inside});
  for (LevelWarning& one : check_shape(shape, false)) report.warnings.push_back(std::move(one));
  for (LevelWarning& one : check_voxels(ct.geometry.spacing_mm)) report.warnings.push_back(std::move(one));
  report.severity = total_severity(report.warnings);
  return report;
}

void set_name(LevelReport& report, const Names& names, std::size_t index) {
  const Level level = names.levels()[index];
  const std::size_t from_above = names.levels().size() - 1 - index;
  report.level = level;
  report.name_source = level == Level::kNone ? NameSource::counted : names.source;
  report.name_probabilities = names.found.probabilities[index];
  report.name = level == Level::kNone ? "V" + std::to_string(from_above + 1) : level_name(level);
  report.label = level == Level::kNone ? kFirstUnnamedLabel + static_cast<int>(from_above) : static_cast<int>(level);
  if (level != Level::kC2) return;
  report.warnings.push_back({"C2 is looked for as bodies further down are: of its dens and ring parts may be missing",
                             kSuspect, std::nullopt});
  report.severity = total_severity(report.warnings);
}

BoneReport bone_of(const BoneLevels& levels) {
  return {.threshold_hu = levels.low_hu, .sure_threshold_hu = levels.sure_hu, .noise_hu = levels.noise_hu};
}

SpineSegmentation spine_of(const CtVolume& ct, const SpineBodies& spine, const SegmentOptions& options,
                           const Progress& progress) {
  Names names = names_of(spine, options, unknown_ribs(spine));
  if (!options.corrections.empty() && options.names.empty() && !spine.has_sacrum) {
    const bool any_level = std::any_of(options.corrections.begin(), options.corrections.end(),
                                       [](const Correction& c) { return c.level != Level::kNone; });
    if (any_level) fail("corrections of levels: expected a point that names one of them, found none");
  }
  SpineSegmentation result;
  result.bone = bone_of(spine.levels);
  result.gaps = gaps_in_row(spine);
  result.labels.geometry = ct.geometry;
  result.labels.labels.assign(ct.geometry.voxel_count(), 0);
  std::vector<Ribs> ribs = unknown_ribs(spine);
  // Labels are indices from below, plus one, until all names are known.
  cut_levels(
      ct, spine, 0, spine.bodies.size() - 1, marks_of(ct, options.corrections, names.levels()),
      [&](CutVertebra&& cut) {
        for_box(ct.geometry, cut.ribs_box, [&](std::size_t to, std::size_t from) {
          if (cut.ribs[from] != 0 && result.labels.labels[to] == 0) result.labels.labels[to] = kRibsLabel;
        });
        for_box(ct.geometry, cut.box, [&](std::size_t to, std::size_t from) {
          if (cut.inside[from] != 0)
            result.labels.labels[to] = static_cast<std::uint8_t>(kFirstUnnamedLabel + cut.index);
        });
        ribs[cut.index] = ribs_of(cut);
        result.levels.push_back(report_of(ct, spine, cut));
      },
      progress);
  if (options.names.empty()) names = names_of(spine, options, ribs);
  result.transitional = names.found.transitional;
  const std::size_t count = result.levels.size();
  std::array<std::uint8_t, 256> renamed{};
  renamed[kRibsLabel] = kRibsLabel;
  for (std::size_t n = 0; n < count; ++n) {
    set_name(result.levels[n], names, n);
    renamed[kFirstUnnamedLabel + n] = static_cast<std::uint8_t>(result.levels[n].label);
    result.labels.names[result.levels[n].label] = {result.levels[n].name, names.levels()[n]};
  }
  bool any_rib = false;
  for (std::uint8_t& label : result.labels.labels) {
    label = renamed[label];
    any_rib = any_rib || label == kRibsLabel;
  }
  if (any_rib) result.labels.names[kRibsLabel] = {"ribs", Level::kNone};
  std::reverse(result.levels.begin(), result.levels.end());
  std::erase_if(result.levels, [](const LevelReport& level) { return level.level == Level::kSacrum; });
  return result;
}

Segmentation vertebra_of(const CtVolume& ct, const SpineBodies& spine, const SegmentOptions& options,
                         const Progress& progress) {
  const std::size_t lowest = spine.has_sacrum ? 1 : 0;
  std::size_t index = lowest;
  if (options.seed_mm) {
    index = body_of(spine, "seed", *options.seed_mm);
  } else if (options.names.size() == 1) {
    index = body_of(spine, level_name(options.names[0].level), options.names[0].p_mm);
  } else {
    // The largest of those that are whole, of all where none is.
    const auto size = [&](std::size_t n) {
      return std::pair(!spine.chain[n].is_cut(), spine.bodies[n].cylinder.half_mm.prod());
    };
    for (std::size_t n = lowest + 1; n < spine.bodies.size(); ++n) {
      if (size(n) > size(index)) index = n;
    }
  }
  if (spine.has_sacrum && index == 0) fail("seed: expected a point in a vertebra, found the sacrum");
  const Names names = names_of(spine, options, unknown_ribs(spine));
  Segmentation result;
  result.bone = bone_of(spine.levels);
  CutVertebra vertebra;
  cut_levels(
      ct, spine, index, index, marks_of(ct, options.corrections, names.levels()),
      [&](CutVertebra&& cut) { vertebra = std::move(cut); }, progress);
  result.report = report_of(ct, spine, vertebra);
  // A name that is counted in a row that lacks vertebrae is another's.
  constexpr double kRowSeverity = 0.1;
  for (const std::string& gap : gaps_in_row(spine)) {
    result.report.warnings.push_back({"the row that it is counted in: " + gap, kRowSeverity, std::nullopt});
  }
  result.report.severity = total_severity(result.report.warnings);
  result.mask = {ct.geometry, std::vector<std::uint8_t>(ct.geometry.voxel_count(), 0)};
  for_box(ct.geometry, vertebra.box,
          [&](std::size_t to, std::size_t from) { result.mask.inside[to] = vertebra.inside[from]; });
  if (mask_box(result.mask).empty()) fail("found no bone around ", in_words(result.report.body_centre_mm));
  set_name(result.report, names, index);
  result.seed_mm = options.seed_mm ? *options.seed_mm : result.report.body_centre_mm;
  const bool is_asked_for = options.seed_mm || options.names.size() == 1;
  result.choice = joined(result.report.name, " of ", spine.bodies.size() - lowest, " found",
                         is_asked_for           ? ""
                         : result.report.is_cut ? ", the largest; none is whole"
                                                : ", the largest that is whole",
                         result.report.level == Level::kNone ? "; its level is not known" : "");
  return result;
}

/// The bone that was kept of a masked CT, for a vertebra in which no body and canal were seen.
LevelReport report_of_kept(const MaskedCt& masked) {
  LevelReport report;
  const GridGeometry& geometry = masked.kept.geometry;
  Vec3 sum = Vec3::Zero();
  for_box(geometry, mask_box(masked.kept), [&](std::size_t offset, std::size_t) {
    if (masked.kept.inside[offset] == 0) return;
    const auto slice = static_cast<std::ptrdiff_t>(geometry.offset(0, 0, 1));
    const auto row = static_cast<std::ptrdiff_t>(geometry.offset(0, 1, 0));
    const auto at = static_cast<std::ptrdiff_t>(offset);
    sum += Eigen::Matrix<std::ptrdiff_t, 3, 1>(at % row, at % slice / row, at / slice).cast<double>();
  });
  report.body_centre_mm = geometry.to_patient(sum * geometry.spacing_mm.prod() / masked.kept_mm3);
  report.volume_mm3 = masked.kept_mm3;
  report.warnings = {{"the CT is masked, and no body and canal were seen in the bone that it keeps: taken as it stands",
                      kSuspect, std::nullopt}};
  report.severity = total_severity(report.warnings);
  set_name(report, {{{Level::kNone}, {{}}, {}}, NameSource::counted}, 0);
  return report;
}

/// Where all of a masked CT is one vertebra, its mask is better than what thresholds find in it: then `found`, a report
/// of that, is made one of the mask.
bool take_kept(const MaskedCt& masked, const SpineBodies& spine, LevelReport& found) {
  constexpr double kMostMore = 1.25;  // a mask that was drawn with a margin is none of a bone
  if (!masked.is_one || spine.bodies.size() != 1 || !(masked.kept_mm3 < kMostMore * found.volume_mm3)) return false;
  found.volume_mm3 = masked.kept_mm3;
  found.warnings.push_back({"the CT is masked: the bone that it keeps is taken as it stands", 0.1, std::nullopt});
  found.severity = total_severity(found.warnings);
  return true;
}

/// As bodies_for(), and empty where there is no spine, but a bone that may be a vertebra.
SpineBodies bodies_in_masked(const MaskedCt& masked, const SegmentOptions& options, const Progress& progress) {
  if (options.seed_mm || !options.names.empty() || !masked.is_one) return bodies_for(masked.ct, options, progress);
  return find_spine_bodies(masked.ct, options.threshold_hu, std::nullopt, progress);
}

}  // namespace

SpineSegmentation segment_spine(const CtVolume& ct, const SegmentOptions& options, const Progress& progress) {
  check_points(ct, options);
  const std::optional<MaskedCt> masked = as_masked(ct);
  if (!masked) return spine_of(ct, bodies_for(ct, options, progress), options, progress);
  const SpineBodies spine = bodies_in_masked(*masked, options, progress);
  SpineSegmentation result;
  if (spine.bodies.empty()) {
    result.bone = bone_of(spine.levels);
    result.levels = {report_of_kept(*masked)};
  } else {
    result = spine_of(masked->ct, spine, options, progress);
    BoneMask labels = crop(BoneMask{masked->ct.geometry, std::move(result.labels.labels)}, masked->original);
    result.labels.labels = std::move(labels.inside);
    result.labels.geometry = ct.geometry;
    if (result.levels.empty() || !take_kept(*masked, spine, result.levels.front())) return result;
  }
  const LevelReport& one = result.levels.front();
  result.labels.geometry = ct.geometry;
  result.labels.labels = masked->kept.inside;
  for (std::uint8_t& label : result.labels.labels) label = label != 0 ? static_cast<std::uint8_t>(one.label) : 0;
  result.labels.names = {{one.label, {one.name, one.level}}};
  return result;
}

Segmentation segment_vertebra(const CtVolume& ct, const SegmentOptions& options, const Progress& progress) {
  check_points(ct, options);
  const std::optional<MaskedCt> masked = as_masked(ct);
  if (!masked) return vertebra_of(ct, bodies_for(ct, options, progress), options, progress);
  const SpineBodies spine = bodies_in_masked(*masked, options, progress);
  Segmentation result;
  if (spine.bodies.empty()) {
    result.bone = bone_of(spine.levels);
    result.report = report_of_kept(*masked);
    result.mask = masked->kept;
    result.seed_mm = result.report.body_centre_mm;
    result.choice = "the bone that a masked CT keeps; its level is not known";
    return result;
  }
  result = vertebra_of(masked->ct, spine, options, progress);
  result.mask = crop(result.mask, masked->original);
  if (take_kept(*masked, spine, result.report)) result.mask = masked->kept;
  return result;
}

}  // namespace spinaltap

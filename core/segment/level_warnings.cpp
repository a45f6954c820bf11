#include "core/segment/level_warnings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/lerp.h"
#include "core/base/text_writer.h"
#include "core/segment/detail/connected_parts.h"
#include "core/segment/detail/warning_list.h"
#include "core/segment/distance_transform.h"

namespace spinaltap {
namespace {

/// The mean place of the canal beside the body, in the body's frame; nothing where no canal was found.
std::optional<Vec3> canal_beside(const SpinalCanal& canal, const BodyCylinder& body) {
  const Mat3 to_body = body.axes().transpose();
  Vec3 sum = Vec3::Zero();
  double count = 0.0;
  for (const Vec3& p_mm : canal.points_mm) {
    const Vec3 p = to_body * (p_mm - body.centre_mm);
    if (std::abs(p.z()) > body.half_mm.z() || p.head<2>().norm() > 60.0) continue;
    sum += p;
    count += 1.0;
  }
  if (count == 0.0) return std::nullopt;
  return Vec3(sum / count);
}

Vec3 canal_or_behind(const SpinalCanal& canal, const BodyCylinder& body) {
  constexpr double kBehindMm = 8.0;
  return canal_beside(canal, body).value_or(Vec3(0.0, body.half_mm.y() + kBehindMm, 0.0));
}

/// Spinous processes lean to one side.
constexpr double kSpinousMm = 14.0;

/// Where a place in a body's frame lies among the contacts with other bone.
Contact contact_at(const Vec3& p, bool is_vertebra, const BodyCylinder& body) {
  constexpr double kBesideMm = 3.0;
  constexpr double kBehindMm = 4.0;
  if (std::abs(p.x()) < body.half_mm.x() + kBesideMm && p.y() < body.half_mm.y() + kBehindMm) {
    constexpr double kEnd = 0.6;  // of half a height: endplates are bowls
    if (!is_vertebra || std::abs(p.z()) < kEnd * body.half_mm.z()) return Contact::beside;
    return p.z() > 0.0 ? Contact::body_above : Contact::body_below;
  }
  const bool is_left = p.x() > 0.0;
  if (!is_vertebra) return is_left ? Contact::left_rib : Contact::right_rib;
  if (p.z() > 0.0) return is_left ? Contact::upper_left : Contact::upper_right;
  return is_left ? Contact::lower_left : Contact::lower_right;
}

/// Sums over the faces between the vertebra and other bone of their area times how well bone goes on through them.
std::array<Bridge, kContacts> find_bridges(const LevelCut& cut, const CutMasks& masks, const BodyCylinder& body) {
  const GridGeometry& geometry = cut.geometry;
  const std::vector<std::uint8_t>& mine = masks.given;
  const std::array<std::size_t, 3> stride{1, geometry.offset(0, 1, 0), geometry.offset(0, 0, 1)};
  const Mat3 to_body = body.axes().transpose();
  std::array<Bridge, kContacts> bridges{};
  for (int k = 0; k + 1 < geometry.size[2]; ++k) {
    for (int j = 0; j + 1 < geometry.size[1]; ++j) {
      for (int i = 0; i + 1 < geometry.size[0]; ++i) {
        const std::size_t here = geometry.offset(i, j, k);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const std::size_t next = here + stride[axis];
          if ((mine[here] != 0) == (mine[next] != 0)) continue;
          const std::size_t other = mine[here] != 0 ? next : here;
          if (cut.markers[other] == WalkerVoxel::kOutside) continue;
          const double through = static_cast<double>(std::min(cut.conductivity[here], cut.conductivity[next]));
          const double mm2 =
              through * geometry.spacing_mm.prod() / geometry.spacing_mm[static_cast<Eigen::Index>(axis)];
          const Vec3 p_mm = geometry.to_patient(Vec3(i, j, k));
          const Contact contact = contact_at(to_body * (p_mm - body.centre_mm), masks.others[other] != 0, body);
          Bridge& bridge = bridges[static_cast<std::size_t>(contact)];
          bridge.mm2 += mm2;
          bridge.where_mm += mm2 * p_mm;
        }
      }
    }
  }
  for (Bridge& bridge : bridges) {
    if (bridge.mm2 > 0.0) bridge.where_mm /= bridge.mm2;
  }
  return bridges;
}

/// How far a place in a body's frame lies to the left of the plane through the body's middle and the canal.
double side_of(const Vec3& p, const Vec3& canal) {
  return p.x() - canal.x() * std::clamp(p.y() / canal.y(), -0.5, 1.5);
}

/// A plane that one side is mirrored to the other by, in a body's frame.
struct MirrorPlane {
  Vec3 through;
  Vec3 normal;
  double side_of(const Vec3& p) const { return (p - through).dot(normal); }
  Vec3 mirrored(const Vec3& p) const { return p - 2.0 * side_of(p) * normal; }
};

/// The plane through the body's middle and the canal, and others near it: in a spine that turns to a side the arch is
/// turned and tilted against the body.
std::vector<MirrorPlane> mirror_planes(const Vec3& canal) {
  constexpr std::array<double, 5> kTurnsRad{0.0, -0.06, 0.06, -0.12, 0.12};
  const double to_canal = std::atan2(canal.x(), canal.y());
  std::vector<MirrorPlane> planes;
  for (const double about_z : kTurnsRad) {
    for (const double about_y : kTurnsRad) {
      const Mat3 turn =
          (Eigen::AngleAxisd(about_z - to_canal, Vec3::UnitZ()) * Eigen::AngleAxisd(about_y, Vec3::UnitY()))
              .toRotationMatrix();
      planes.push_back({Vec3(canal.x(), canal.y(), 0.0), turn.col(0)});
    }
  }
  return planes;
}

/// The largest piece of the arch that a plane mirrors to where the vertebra is not; of the planes, by the
/// one that leaves the least of the arch without its like, where that is less than half of what the plain one leaves.
void find_lopsided(const LevelCut& cut, const std::vector<std::uint8_t>& mine, const BodyCylinder& body,
                   const Vec3& canal, LevelFigures& figures) {
  const GridGeometry& geometry = cut.geometry;
  // Vertebrae are hardly more alike, and in voxels over 1 mm each side is so much less sure.
  const double far_mm = 4.0 + std::max(0.0, geometry.spacing_mm.maxCoeff() - 1.0);
  const Mat3 axes = body.axes();
  const std::vector<float> to_mine = squared_distance_within(mine, geometry, far_mm);
  std::vector<std::pair<std::size_t, Vec3>> arch;
  for_voxels_by_body(mine, geometry, body, [&](std::size_t voxel, const Vec3& p) {
    if (p.y() >= body.half_mm.y()) arch.emplace_back(voxel, p);
  });
  std::vector<std::size_t> plain, least, alone;
  bool is_first = true;
  for (const MirrorPlane& plane : mirror_planes(canal)) {
    alone.clear();
    for (const auto& [voxel, p] : arch) {
      if (p.y() > canal.y() + kSpinousMm && std::abs(plane.side_of(p)) < kSpinousMm) continue;
      const Vec3 mirrored = geometry.to_index(body.centre_mm + axes * plane.mirrored(p));
      const Eigen::Vector3i at = mirrored.array().round().cast<int>();
      // What the box does not hold is no vertebra's.
      const bool is_near = geometry.contains(at.x(), at.y(), at.z()) &&
                           to_mine[geometry.offset(at.x(), at.y(), at.z())] < far_mm * far_mm;
      if (!is_near) alone.push_back(voxel);
    }
    if (is_first) plain = least = alone;
    if (alone.size() < least.size()) least = alone;
    is_first = false;
  }
  // A piece that is too much can be turned away in part; what was turned in the spine goes nearly whole.
  if (2 * least.size() > plain.size()) least = std::move(plain);
  std::vector<std::uint8_t> without_like(mine.size(), 0);
  for (const std::size_t voxel : least) without_like[voxel] = 1;
  Vec3 sum_mm = Vec3::Zero();
  double count = 0.0;
  for_voxels_by_body(largest_part(without_like, geometry), geometry, body, [&](std::size_t, const Vec3& p) {
    sum_mm += body.centre_mm + axes * p;
    count += 1.0;
  });
  if (count == 0.0) return;
  figures.lopsided_mm3 = count * geometry.spacing_mm.prod();
  figures.lopsided_at_mm = sum_mm / count;
}

const char* name_of(Contact contact) {
  switch (contact) {
    case Contact::body_above:
      return "the body above";
    case Contact::body_below:
      return "the body below";
    case Contact::beside:
      return "the bone beside its body";
    case Contact::upper_left:
      return "the vertebra above, in the left joint";
    case Contact::upper_right:
      return "the vertebra above, in the right joint";
    case Contact::lower_left:
      return "the vertebra below, in the left joint";
    case Contact::lower_right:
      return "the vertebra below, in the right joint";
    case Contact::left_rib:
      return "the left rib";
    case Contact::right_rib:
      return "the right rib";
  }
  return "";
}

template <class... Parts>
std::string words(const Parts&... parts) {
  TextWriter text(3);
  (text << ... << parts);
  return text.str();
}

/// A body of another size than its neighbours that are whole: where there are two, than either, so that a crushed body
/// speaks against itself alone.
void check_sizes(const std::vector<BodySpan>& chain, const BodyInRow& row, WarningList& warnings) {
  struct Neighbour {
    const char* side;
    Vec3 ratio;
  };
  std::vector<Neighbour> neighbours;
  const Vec3& half_mm = row.body().cylinder.half_mm;
  for (const std::size_t other : {row.own - 1, row.own + 1}) {
    if (other >= chain.size() || chain[other].is_cut()) continue;
    neighbours.push_back(
        {other < row.own ? "lower" : "upper", half_mm.cwiseQuotient(row.bodies[other].cylinder.half_mm)});
  }
  if (neighbours.empty()) return;
  for (const auto& [axis, name] : {std::pair{0, "wide"}, std::pair{1, "deep"}, std::pair{2, "high"}}) {
    const auto off = [n = axis](const Neighbour& one) { return std::abs(std::log(one.ratio[n])); };
    const auto nearest =
        std::min_element(neighbours.begin(), neighbours.end(),
                         [&](const Neighbour& one, const Neighbour& other) { return off(one) < off(other); });
    warnings.add(0.6 * ramp(off(*nearest), std::log(1.3), std::log(1.6)),
                 words("the body is ", nearest->ratio[axis], " times as ", name, " as its ", nearest->side,
                       " neighbour", neighbours.size() > 1 ? ", and as unlike the other" : ""),
                 row.body().cylinder.centre_mm);
  }
}

/// Bodies that touch, joints and ribs that no gap shows: each is told.
///
/// Bodies are parted half way between two endplates; thin discs close in coarse and blurred CTs without harm to either,
/// and where an endplate is weak besides, that counts. Cuts through joints and ribs cost a vertebra little, neighbours
/// share them, and where the walker is unsure it is there: all together speak against it by their area, or by how much
/// is unsure where that is more.
void check_bridges(const LevelFigures& figures, WarningList& warnings) {
  constexpr double kWorthAWordMm2 = 12.0, kManyMm2 = 90.0, kNoteSeverity = 0.02;
  const auto text_of = [](double mm2, Contact contact) {
    return words("no gap shows over ", mm2, " mm2 between it and ", name_of(contact), ": the cut there is a guess");
  };
  const auto bridge_of = [&](Contact contact) { return figures.bridges[static_cast<std::size_t>(contact)]; };
  for (const Contact contact : {Contact::body_above, Contact::body_below}) {
    const Bridge& bridge = bridge_of(contact);
    if (bridge.mm2 >= kManyMm2) warnings.note(kNoteSeverity, text_of(bridge.mm2, contact), bridge.where_mm);
  }
  const Bridge& beside = bridge_of(Contact::beside);
  warnings.add(0.7 * ramp(beside.mm2, kManyMm2, 200.0), text_of(beside.mm2, Contact::beside), beside.where_mm);
  std::vector<std::size_t> told;
  double sum_mm2 = 0.0;
  for (std::size_t n = static_cast<std::size_t>(Contact::upper_left); n < kContacts; ++n) {
    if (figures.bridges[n].mm2 < kWorthAWordMm2) continue;
    told.push_back(n);
    sum_mm2 += figures.bridges[n].mm2;
  }
  // Of levels of real CTs whose joints close, at any resolution and kernel, a quarter lost a process or a tenth of
  // Dice.
  const double severity = 0.3 * ramp(sum_mm2, 15.0, 60.0);
  for (const std::size_t n : told) {
    // What they leave of the whole together is what the sum's severity does.
    const double own = 1.0 - std::pow(1.0 - severity, figures.bridges[n].mm2 / sum_mm2);
    warnings.note(std::max(own, kNoteSeverity), text_of(figures.bridges[n].mm2, static_cast<Contact>(n)),
                  figures.bridges[n].where_mm);
  }
  const double unsure = 0.6 * ramp(figures.unsure_share, 0.18, 0.35);
  const double beyond = unsure > severity ? 1.0 - (1.0 - unsure) / (1.0 - severity) : 0.0;
  if (unsure < WarningList::kMin) return;
  warnings.note(std::max(beyond, kNoteSeverity),
                words("of ", 100.0 * figures.unsure_share, " % of it, it is unsure whose they are"), std::nullopt);
}

}  // namespace

LevelFigures measure_level(const LevelCut& cut, const CutMasks& masks, const BodyInRow& row) {
  const std::vector<std::uint8_t>& mine = masks.finished;
  const BodyCylinder& body = row.body().cylinder;
  const double voxel_mm3 = cut.geometry.spacing_mm.prod();
  LevelFigures figures;
  const Vec3 canal = canal_or_behind(row.canal, body);
  constexpr int kDirections = 72;
  constexpr double kSlabMm = 2.0;
  constexpr double kMinSideMm = 4.0;
  constexpr std::size_t kSlabs = 9;
  std::array<std::array<double, kSlabs>, 2> sections{};
  // Voxels count with the share of their depth that lies in a slab.
  const double voxel_depth_mm = body.axes().col(1).cwiseAbs().dot(cut.geometry.spacing_mm);
  const double max = std::min(1.0, kSlabMm / voxel_depth_mm);
  std::array<bool, kDirections> seen{};
  double left = 0.0;
  double all = 0.0;
  double unsure = 0.0;
  std::vector<std::uint8_t> dense(mine.size(), 0);
  for_voxels_by_body(mine, cut.geometry, body, [&](std::size_t voxel, const Vec3& p) {
    const double side = side_of(p, canal);
    all += 1.0;
    if (side > 0.0) left += 1.0;
    if (cut.depth_mm[voxel] <= 0.0F && cut.probability[voxel] < 0.65F) {
      unsure += 1.0;
      figures.unsure_mm.push_back(body.centre_mm + body.axes() * p);
    }
    figures.left_reach_mm = std::max(figures.left_reach_mm, side);
    figures.right_reach_mm = std::max(figures.right_reach_mm, -side);
    figures.behind_canal_mm = std::max(figures.behind_canal_mm, p.y() - canal.y());
    // Slabs from the body's back to behind the canal's middle; a pedicle is as good as its thinnest.
    if (std::abs(side) > kMinSideMm && std::abs(side) < body.half_mm.x() + 8.0 &&
        std::abs(p.z()) < 1.1 * body.half_mm.z()) {
      for (std::size_t n = 0; n < kSlabs; ++n) {
        const double y = lerp(body.half_mm.y(), canal.y() + 2.0, static_cast<double>(n) / (kSlabs - 1));
        const double covered = std::clamp((0.5 * kSlabMm - std::abs(p.y() - y)) / voxel_depth_mm + 0.5, 0.0, max);
        sections[side > 0.0 ? 0 : 1][n] += covered * voxel_mm3 / kSlabMm;
      }
    }
    const double x = p.x() - canal.x();
    const double y = p.y() - canal.y();
    if (std::hypot(x, y) < 22.0 && p.z() > -2.2 * body.half_mm.z() && p.z() < 1.2 * body.half_mm.z()) {
      const double turn = std::atan2(x, y) / (2.0 * std::numbers::pi) + 0.5;
      seen[static_cast<std::size_t>(std::min(kDirections - 1, static_cast<int>(turn * kDirections)))] = true;
    }
    if (cut.brightness[voxel] == Brightness::kMetal) figures.metal_mm3 += voxel_mm3;
    if (cut.brightness[voxel] == Brightness::kCement && cut.depth_mm[voxel] > 4.0F) dense[voxel] = 1;
  });
  figures.left_pedicle_mm2 = *std::min_element(sections[0].begin(), sections[0].end());
  figures.right_pedicle_mm2 = *std::min_element(sections[1].begin(), sections[1].end());
  if (all > 0.0) {
    figures.left_share = left / all;
    figures.unsure_share = unsure / all;
  }
  figures.canal_closed = static_cast<double>(std::count(seen.begin(), seen.end(), true)) / kDirections;
  const std::vector<std::size_t> lumps = part_sizes(dense, cut.geometry);
  if (!lumps.empty()) figures.cement_mm3 = static_cast<double>(lumps.front()) * voxel_mm3;
  figures.bridges = find_bridges(cut, masks, body);
  find_lopsided(cut, mine, body, canal, figures);
  return figures;
}

bool find_border(const GridGeometry& ct, const VoxelBox& box, const std::vector<std::uint8_t>& inside,
                 const BodyInRow& row, LevelFigures& figures) {
  constexpr double kMinMm2 = 4.0;  // a voxel may be noise's
  const BodyCylinder& body = row.body().cylinder;
  const Vec3 canal = canal_or_behind(row.canal, body);
  const Mat3 to_body = body.axes().transpose();
  double behind_mm2 = 0.0, left_mm2 = 0.0, right_mm2 = 0.0;
  bool reaches = false;
  std::size_t voxel = 0;
  for (int k = box.low[2]; k <= box.high[2]; ++k) {
    for (int j = box.low[1]; j <= box.high[1]; ++j) {
      for (int i = box.low[0]; i <= box.high[0]; ++i, ++voxel) {
        const bool at_i = i == 0 || i == ct.size[0] - 1, at_j = j == 0 || j == ct.size[1] - 1;
        const bool at_k = k == 0 || k == ct.size[2] - 1;
        if (inside[voxel] == 0 || !(at_i || at_j || at_k)) continue;
        reaches = true;
        const int axis = at_i ? 0 : at_j ? 1 : 2;
        const double mm2 = ct.spacing_mm.prod() / ct.spacing_mm[axis];
        const Vec3 p = to_body * (ct.to_patient(Vec3(i, j, k)) - body.centre_mm);
        const double side = side_of(p, canal);
        if (std::abs(side) < kSpinousMm && p.y() > canal.y()) behind_mm2 += mm2;
        if (side > 0.5 * body.half_mm.x()) left_mm2 += mm2;
        if (-side > 0.5 * body.half_mm.x()) right_mm2 += mm2;
      }
    }
  }
  figures.is_cut_behind = behind_mm2 >= kMinMm2;
  figures.is_cut_left = left_mm2 >= kMinMm2;
  figures.is_cut_right = right_mm2 >= kMinMm2;
  return reaches;
}

std::vector<LevelWarning> check_level(const LevelFigures& figures, const std::vector<BodySpan>& chain,
                                      const BodyInRow& row) {
  WarningList warnings;
  const BodySpan& span = chain[row.own];
  const BodyCylinder& body = row.body().cylinder;
  const bool is_cut = span.is_cut();
  for (const auto& [end, name] : {std::pair{&span.upper, "upper"}, std::pair{&span.lower, "lower"}}) {
    if (end->is_cut) {
      warnings.add(0.3, words("the body goes on beyond the CT: its ", name, " end is not in it"));
      continue;
    }
    warnings.add(0.7 * ramp(-end->edge, -0.35, -0.1),
                 words("the ", name, " endplate is weak: ", end->edge, " of a clear one, expected 0.35 and more"),
                 end->centre_mm);
  }
  if (!is_cut) check_sizes(chain, row, warnings);
  // Gaps to the neighbours that are whole.
  for (const std::size_t other : {row.own - 1, row.own + 1}) {
    if (other >= chain.size() || is_cut || chain[other].is_cut()) continue;
    const char* side = other < row.own ? "lower" : "upper";
    const BodySpan& lower = other < row.own ? chain[other] : span;
    const BodySpan& upper = other < row.own ? span : chain[other];
    const double gap_mm = (upper.lower.centre_mm - lower.upper.centre_mm).norm();
    const double height_mm = std::min(lower.height_mm(), upper.height_mm());
    warnings.add(0.6 * ramp(gap_mm / height_mm, 0.6, 0.9),
                 words("the gap to the ", side, " neighbour is ", gap_mm, " mm high: a body may be missing there"),
                 Vec3(0.5 * (upper.lower.centre_mm + lower.upper.centre_mm)));
  }
  // Beyond the outermost bodies.
  for (const bool is_top : {false, true}) {
    if (row.own != (is_top ? chain.size() - 1 : 0)) continue;
    const BodyEnd& end = is_top ? span.upper : span.lower;
    if (end.is_cut || row.canal.points_mm.empty()) continue;
    const Vec3& last = is_top ? row.canal.points_mm.back() : row.canal.points_mm.front();
    const double beyond = (last - end.centre_mm).dot(end.up) * (is_top ? 1.0 : -1.0) / (2.0 * body.half_mm.z());
    warnings.add(0.6 * ramp(beyond, 0.6, 1.0),
                 words("the canal goes on for ", beyond, " of a body's height ", is_top ? "above" : "below",
                       ": a vertebra may be missing there"),
                 last);
  }
  const double height_over_depth = body.half_mm.z() / body.half_mm.y();
  if (!is_cut) {
    warnings.add(0.8 * ramp(height_over_depth, 1.15, 1.5),
                 words("the body is ", height_over_depth, " times as high as deep, expected up to 1.15"),
                 body.centre_mm);
    warnings.add(0.6 * ramp(-height_over_depth, -0.5, -0.35),
                 words("the body is only ", height_over_depth, " times as high as deep, expected 0.5 and more"),
                 body.centre_mm);
  }
  constexpr double kClearFit = 0.33;
  warnings.add(0.7 * ramp(-body.fit, -kClearFit, -0.23),
               words("the body's wall is faint: ", body.fit, " of a clear one, expected ", kClearFit, " and more"),
               body.centre_mm);
  // What is beyond the CT cannot be missed here.
  const double missing = is_cut ? 0.4 : 0.8;
  for (const auto& [mm2, name] :
       {std::pair{figures.left_pedicle_mm2, "left"}, std::pair{figures.right_pedicle_mm2, "right"}}) {
    warnings.add(missing * ramp(-mm2, -14.0, -5.0),
                 words("the ", name, " pedicle has ", mm2, " mm2 of bone where it is thinnest, expected 14 and more"));
  }
  warnings.add(missing * ramp(-figures.canal_closed, -0.97, -0.85),
               words("the vertebra closes ", 100.0 * figures.canal_closed, " % of the way around the canal"));
  // What ends at the CT's border is told, and is no fault of the cut.
  const auto unless_cut = [](double severity, bool is_at_border) {
    return is_at_border ? std::min(severity, WarningList::kMin) : severity;
  };
  const double spinous = missing * ramp(-figures.behind_canal_mm, -17.0, -11.0);
  warnings.add(unless_cut(spinous, figures.is_cut_behind),
               words("it ends ", figures.behind_canal_mm, " mm behind the canal's middle",
                     figures.is_cut_behind ? ", at the CT's border: the spinous process is cut there"
                                           : ": the spinous process is missing"));
  const double lean = 0.8 * ramp(std::abs(figures.left_share - 0.5), 0.06, 0.11);
  const bool is_less_cut = figures.left_share < 0.5 ? figures.is_cut_left : figures.is_cut_right;
  warnings.add(unless_cut(lean, is_less_cut),
               words(100.0 * figures.left_share, " % of it lie to the left: one side ",
                     is_less_cut ? "is cut by the CT's border" : "has too much or too little"));
  const double reach = 0.7 * ramp(std::abs(figures.left_reach_mm - figures.right_reach_mm), 7.0, 14.0);
  const bool is_shorter_cut =
      figures.left_reach_mm < figures.right_reach_mm ? figures.is_cut_left : figures.is_cut_right;
  warnings.add(
      unless_cut(reach, is_shorter_cut),
      words(
          "it reaches ", figures.left_reach_mm, " mm to the left and ", figures.right_reach_mm, " mm to the right",
          is_shorter_cut ? ", on one side to the CT's border" : ": a rib may have stayed on, or a process be cut off"));
  check_bridges(figures, warnings);
  warnings.add(
      0.7 * ramp(figures.lopsided_mm3, 300.0, 1000.0),
      words("a piece of ", figures.lopsided_mm3,
            " mm3 has no like on the other side: a process may be missing there, or a rib have stayed on here"),
      figures.lopsided_at_mm);
  warnings.add(figures.metal_mm3 > 30.0 ? 0.6 : 0.0,
               words("metal: ", figures.metal_mm3, " mm3 over 2500 HU; CT numbers around it are not bone's"));
  warnings.add(figures.cement_mm3 > 500.0 ? 0.55 : 0.0,
               words("a dense lump of ", figures.cement_mm3, " mm3 in the body, as of cement"), body.centre_mm);
  return warnings.take();
}

std::vector<LevelWarning> check_voxels(const Vec3& spacing_mm) {
  // Of a real CT in slices of 2.5 and 3 mm all whole levels have a Dice of 0.83 and more with what is found in it as it
  // is; of 4 mm 6 of 11 have 0.8, of 5 mm 4 of 14.
  constexpr double kFineMm = 3.0, kCoarseMm = 3.5;
  const double widest_mm = spacing_mm.maxCoeff();
  WarningList warnings;
  warnings.add(kSuspect * ramp(widest_mm, kFineMm, kCoarseMm),
               words("the CT's voxels are ", widest_mm, " mm long: bodies can be parted in it, arches cannot"));
  return warnings.take();
}

double total_severity(const std::vector<LevelWarning>& warnings) {
  double sound = 1.0;
  for (const LevelWarning& warning : warnings) sound *= 1.0 - warning.severity;
  return 1.0 - sound;
}

}  // namespace spinaltap

#include "core/grading/instrument.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/base/text_writer.h"
#include "core/grading/detail/instrument_body.h"

namespace spinaltap {
namespace {

/// A place of the surface and how far it is from a body.
struct Touch {
  double distance_mm = std::numeric_limits<double>::infinity();
  Vec3 place_mm = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
};

/// The surface's place nearest to the body, or deepest in it, around a sample of it.
Touch refined(const BoneShape& bone, const PathLine& line, const InstrumentBody& body, Touch best) {
  constexpr int kAround = 8, kHalvings = 4;
  double step_mm = 0.5 * BoneShape::kSampleMm;
  for (int halving = 0; halving < kHalvings; ++halving, step_mm *= 0.5) {
    const Vec3 u = any_perpendicular(best.normal);
    const Vec3 v = best.normal.cross(u);
    std::array<Vec3, kAround> places_mm;
    for (int n = 0; n < kAround; ++n) {
      const double angle = 2.0 * std::numbers::pi * n / kAround;
      places_mm[static_cast<std::size_t>(n)] = best.place_mm + step_mm * (std::cos(angle) * u + std::sin(angle) * v);
    }
    std::array<double, kAround> values_mm{};
    std::array<Vec3, kAround> gradients;
    bone.surface().evaluate(places_mm, values_mm, gradients);
    for (std::size_t n = 0; n < kAround; ++n) {
      const double squared = gradients[n].squaredNorm();
      if (!(squared > 0.01)) continue;
      const Vec3 place_mm = places_mm[n] - values_mm[n] / squared * gradients[n];
      const double distance_mm = line.distance_mm(body, place_mm);
      if (distance_mm < best.distance_mm) best = {distance_mm, place_mm, gradients[n] / std::sqrt(squared)};
    }
  }
  return best;
}

std::string millimetres(double mm) { return fixed_text(mm, 1) + " mm"; }

Finding finding_of(const DrillPath& path, const InstrumentBody& body, VertebraPart structure, const Touch& touch,
                   double along_mm) {
  Finding finding{body.part, structure, -touch.distance_mm, along_mm, touch.place_mm, false, ""};
  const bool is_joint = structure == VertebraPart::superior_joint;
  const std::string name = name_of(structure);
  const std::string deep = millimetres(finding.depth_mm);
  const std::string behind = millimetres(-along_mm) + " behind the entry";
  switch (body.part) {
    case InstrumentPart::way_in:
      finding.is_warning = true;
      finding.words = "on its way in the " + name_of(InstrumentPart::tool, path) + " cuts " + deep + " into the " +
                      name + ", " + behind;
      break;
    case InstrumentPart::head:
      finding.is_warning = is_joint || finding.depth_mm > kSeatMm;
      finding.words = "the screw's head stands " + deep + " in the " + name + ", " + behind +
                      (is_joint             ? ": back it out or choose another entry"
                       : finding.is_warning ? ": back it out, or cut a deep seat for it"
                                            : ": a seat is cut for it with a burr");
      break;
    default:
      finding.is_warning = true;
      finding.words = "the driver stands " + deep + " in the " + name + ", " + behind;
      break;
  }
  return finding;
}

}  // namespace

std::string name_of(InstrumentPart part, const DrillPath& path) {
  switch (part) {
    case InstrumentPart::tool:
      return path.screw ? "screw" : "bit";
    case InstrumentPart::way_in:
      return "way in";
    case InstrumentPart::head:
      return "head";
    case InstrumentPart::driver:
      break;
  }
  return "driver";
}

double opening_limit_mm(double tool_radius_mm) { return 1.2 * tool_radius_mm + 0.5; }

InstrumentContacts instrument_contacts(const WallDistance& walls, const DrillPath& path, double opening_mm,
                                       double reach_mm) {
  constexpr std::size_t kStructures = 8;
  const BoneShape& bone = walls.bone();
  const PathLine line(path);
  const std::vector<InstrumentBody> bodies = instrument_bodies(path, opening_mm);
  InstrumentContacts contacts;
  const auto note_process = [&](VertebraPart structure, double depth_mm) {
    if (structure == VertebraPart::superior_joint)
      contacts.joint_depth_mm = std::max(contacts.joint_depth_mm, depth_mm);
    contacts.is_beside_joint |= structure == VertebraPart::superior_articular_process;
  };

  struct OfBody {
    Touch nearest;
    std::array<Touch, kStructures> touches;
  };
  std::vector<OfBody> found(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const InstrumentBody& body = bodies[b];
    Touch& nearest = found[b].nearest;
    // Of the way in it matters only how deep bone lies in it, which a sample beside it may still lead to.
    const double within_mm = body.part == InstrumentPart::way_in ? std::min(reach_mm, BoneShape::kSampleMm) : reach_mm;
    const auto limit_mm = [&] { return std::max(0.0, std::min(within_mm, nearest.distance_mm)); };
    std::vector<std::pair<double, const PointTree::Group*>> groups;  // the nearest come first
    for (const PointTree::Group& group : bone.tree().groups()) {
      // What lies beside the body's widest part or ahead of its tip is at least so far from it.
      const double along_mm = line.along_mm(group.middle_mm);
      const double least_mm = std::max(line.off_mm(group.middle_mm, along_mm) - body.profile.radius_mm(),  //
                                       along_mm - body.tip_mm) -
                              group.radius_mm;
      if (least_mm <= limit_mm()) groups.emplace_back(least_mm, &group);
    }
    std::sort(groups.begin(), groups.end());
    for (const auto& [least_mm, group] : groups) {
      if (least_mm > limit_mm()) break;
      for (const std::size_t n : group->points) {
        const Vec3& p_mm = bone.points_mm()[n];
        const double along_mm = line.along_mm(p_mm);
        if (along_mm - body.tip_mm > limit_mm()) continue;
        const double off_squared_mm2 = line.off_squared_mm2(p_mm, along_mm);
        const double far_mm = body.profile.radius_mm() + limit_mm();
        if (off_squared_mm2 > far_mm * far_mm) continue;
        if (nearest.distance_mm < 0.0 && !body.contains(along_mm, off_squared_mm2)) continue;
        const double distance_mm = body.distance_mm(along_mm, std::sqrt(off_squared_mm2));
        if (distance_mm < nearest.distance_mm) nearest = {distance_mm, p_mm, bone.normals()[n]};
        if (!(distance_mm < 0.0)) continue;
        const VertebraPart structure = walls.parts().at(p_mm, bone.normals()[n]);
        Touch& touch = found[b].touches[static_cast<std::size_t>(structure)];
        if (distance_mm < touch.distance_mm) touch = {distance_mm, p_mm, bone.normals()[n]};
        if (body.part == InstrumentPart::head) note_process(structure, -distance_mm);
      }
    }
  }
  if (path.screw) {
    const InstrumentBody thread = screw_body(path);
    for (const std::size_t n : bone.tree().along(
             {path.entry_mm, path.direction(), -opening_mm, path.length_mm(), thread.profile.radius_mm()})) {
      const Vec3& p_mm = bone.points_mm()[n];
      const double along_mm = line.along_mm(p_mm);
      if (along_mm < -opening_mm) continue;
      const double in_thread_mm = -thread.distance_mm(along_mm, line.off_mm(p_mm, along_mm));
      if (in_thread_mm > 0.0) note_process(walls.parts().at(p_mm, bone.normals()[n]), in_thread_mm);
    }
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    OfBody& of_body = found[b];
    if (of_body.nearest.distance_mm > reach_mm) continue;
    of_body.nearest = refined(bone, line, bodies[b], of_body.nearest);
    const double clearance_mm = of_body.nearest.distance_mm;
    if (bodies[b].part == InstrumentPart::head) contacts.head_clearance_mm = clearance_mm;
    if (bodies[b].part == InstrumentPart::driver) contacts.driver_clearance_mm = clearance_mm;
    if (bodies[b].part == InstrumentPart::way_in) contacts.cut_behind_mm = std::max(0.0, -clearance_mm);
    for (std::size_t s = 0; s < kStructures; ++s) {
      Touch touch = of_body.touches[s];
      if (!(touch.distance_mm < 0.0)) continue;
      touch = refined(bone, line, bodies[b], touch);
      const auto structure = static_cast<VertebraPart>(s);
      const bool counts = -touch.distance_mm > kTouchMm ||
                          (structure == VertebraPart::superior_joint && bodies[b].part == InstrumentPart::head);
      if (!counts) continue;
      contacts.findings.push_back(finding_of(path, bodies[b], structure, touch, line.along_mm(touch.place_mm)));
    }
  }
  std::stable_sort(contacts.findings.begin(), contacts.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.depth_mm > b.depth_mm; });
  return contacts;
}

}  // namespace spinaltap

#include "core/grading/neighbour_contact.h"

#include <algorithm>
#include <cmath>

#include "core/base/text_writer.h"
#include "core/grading/detail/graded_tool.h"
#include "core/grading/detail/instrument_body.h"

namespace spinaltap {
namespace {

/// Looks at one body among the other's places, and keeps the deepest.
class DeepestContact {
 public:
  explicit DeepestContact(std::span<const Neighbour> neighbours) : neighbours_(neighbours) {}

  /// `depth_mm(place)`: of a place in the body, and where that is along the path; negative out of it.
  struct Depth {
    double mm, at_mm;
  };
  template <class DepthOf>
  void look(InstrumentPart part, const PointTree::Stretch& stretch, const DepthOf& depth_of) {
    for (const Neighbour& other : neighbours_) {
      for (const std::size_t n : other.shape->tree().along(stretch)) {
        const Vec3& place_mm = other.shape->points_mm()[n];
        const Depth depth = depth_of(place_mm);
        if (depth.mm > deepest_.depth_mm) deepest_ = {depth.mm, other.level, part, depth.at_mm, place_mm};
      }
    }
  }
  const NeighbourContact& deepest() const { return deepest_; }

 private:
  std::span<const Neighbour> neighbours_;
  NeighbourContact deepest_;
};

void look_at_body(const DrillPath& path, const PathLine& line, const InstrumentBody& body, DeepestContact& contact) {
  const PointTree::Stretch stretch{path.entry_mm, line.direction(), body.tip_mm - body.profile.length_mm(), body.tip_mm,
                                   body.profile.radius_mm()};
  contact.look(body.part, stretch, [&](const Vec3& p_mm) {
    return DeepestContact::Depth{-line.distance_mm(body, p_mm), line.along_mm(p_mm)};
  });
}

/// The bit's hole, which may be curved: in pieces so short that they are straight.
void look_at_hole(const DrillPath& path, DeepestContact& contact) {
  constexpr double kPieceMm = 1.0;
  constexpr double kSpareMm = 0.5;
  const GradedTool tool(path);
  const auto depth_of = [&](const Vec3& p_mm) {
    const double at_mm = tool.along_mm(p_mm);
    if (!(at_mm >= 0.0)) return DeepestContact::Depth{-1.0, at_mm};
    return DeepestContact::Depth{tool.radius_mm(at_mm) - (p_mm - tool.axis_mm(at_mm)).norm(), at_mm};
  };
  const int pieces = path.is_curved() ? static_cast<int>(std::ceil(tool.length_mm() / kPieceMm)) : 1;
  for (int n = 0; n < pieces; ++n) {
    const double from_mm = tool.length_mm() * n / pieces, length_mm = tool.length_mm() / pieces;
    contact.look(InstrumentPart::tool,
                 {tool.axis_mm(from_mm), tool.direction_at(from_mm), 0.0, length_mm, tool.widest_mm() + kSpareMm},
                 depth_of);
  }
}

}  // namespace

NeighbourContact neighbour_contact(std::span<const Neighbour> neighbours, const DrillPath& path) {
  check_path(path);
  DeepestContact contact(neighbours);
  if (path.screw) {
    const PathLine line(path);
    look_at_body(path, line, screw_body(path), contact);
    look_at_body(path, line, screw_head(path), contact);
  } else {
    look_at_hole(path, contact);
  }
  return contact.deepest();
}

Finding finding_of(const NeighbourContact& contact, const DrillPath& path) {
  const bool is_behind = contact.at_mm < 0.0;
  const std::string tool = contact.part == InstrumentPart::tool ? name_of(contact.part, path) : "screw's head";
  return {contact.part,
          VertebraPart::other_vertebra,
          contact.depth_mm,
          contact.at_mm,
          contact.place_mm,
          true,
          "the " + tool + " stands " + fixed_text(contact.depth_mm, 1) + " mm in " + level_name(contact.level) + ", " +
              fixed_text(std::abs(contact.at_mm), 1) + " mm " + (is_behind ? "behind the entry" : "deep")};
}

}  // namespace spinaltap

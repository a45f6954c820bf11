#pragma once

#include <memory>
#include <vector>

#include "core/phantom/detail/shape_solid.h"
#include "core/phantom/spine.h"
#include "core/phantom/spine_curve.h"

namespace spinaltap {

/// Measures of the simple solids C1 and C2, as far as a level's measures tell. Throws Error for other levels.
LevelMeasures upper_neck_measures(Level level);

/// Where the middle of C2's dens, which is C1's middle, lies in C2's frame, mm, at scale 1.
inline const Vec3 kDensMm{0.0, -2.0, 20.0};

/// A ring with two lateral masses, and a body with a dens; `scale`: of the patient.
std::shared_ptr<const Solid> make_atlas(const PlacedLevel& atlas, double scale, const ShellBone& bone);
/// `below`: C3, behind whose facets the inferior articular processes end.
std::shared_ptr<const Solid> make_axis(const PlacedLevel& axis, const PlacedLevel& below, double scale,
                                       const ShellBone& bone);

/// The braincase: an ellipsoid over the neck, in C1's frame.
struct SkullPlace {
  Vec3 centre_mm, half_mm;
};
SkullPlace skull_place(double scale);

/// A closed shell with a foramen magnum and two condyles, and a jaw, both above and before C1.
std::shared_ptr<const Solid> make_skull(const PlacedLevel& atlas, double scale, const ShellBone& bone);
std::shared_ptr<const Solid> make_jaw(const PlacedLevel& atlas, double scale);

/// Uncinate processes and the front bars of the transverse foramina of a level below C2, and the tines of its forked
/// spinous process: rods that are joined to it. `above`: null for the uppermost.
std::vector<Spur> cervical_spurs(const PlacedLevel& level, const VertebraAnatomy& anatomy, const PlacedLevel* above);

}  // namespace spinaltap

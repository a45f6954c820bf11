#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/geometry.h"

namespace spinaltap {

/// What a vertebra looks like; the defaults are those of an L3. Lengths in mm, angles in degrees, CT numbers in HU.
/// Positions are given for the left side (+x) in the vertebra's own frame: x to the left, y posterior, z superior,
/// origin in the middle of the body. The right side mirrors the left, but for its pedicle where right_pedicle is given.
struct VertebraAnatomy {
  struct Body {
    double width_mm = 44.0;           ///< across, at the rims
    double depth_mm = 33.0;           ///< front to back in the middle, before the canal hollows the back
    double height_mm = 28.0;          ///< rim to rim
    double waist_mm = 2.0;            ///< how much less than at the rims half the depth is at mid height
    double kidney_mm = 4.0;           ///< how far the back's corners lie behind an ellipse
    double kidney_width_mm = 8.0;     ///< from the middle, where half of kidney_mm is reached
    double superior_hollow_mm = 2.2;  ///< depth of the upper endplate's middle below its rim
    double inferior_hollow_mm = 2.8;  ///< depth of the lower endplate's middle above its rim
    double rim_mm = 2.5;              ///< width of the level rim around an endplate
    double edge_mm = 2.6;             ///< rounding of the edge between wall and endplate
    double wedge_deg = 0.0;           ///< between the endplates, seen from the side; above 0: lower in front
    double side_wedge_deg = 0.0;      ///< between the endplates, seen from the front; above 0: lower on the left
  } body;

  struct Pedicle {
    double width_mm = 9.0;              ///< at the isthmus, at right angles to the axis: exact
    double height_mm = 14.5;            ///< at the isthmus: exact; above the width
    Vec3 isthmus_mm{16.0, 20.5, 2.6};   ///< centre of the isthmus
    double convergence_deg = 12.0;      ///< between the axis and the sagittal plane, forward and inward
    double tilt_deg = 0.0;              ///< of the axis, upward to the front
    double flare_mm = 1.3;              ///< growth of half the width far from the isthmus
    double flare_length_mm = 5.0;       ///< from the isthmus, where half of the flare is reached
    double anterior_length_mm = 13.0;   ///< from the isthmus into the body
    double posterior_length_mm = 10.0;  ///< from the isthmus into the arch
    double blend_mm = 2.5;              ///< reach of the fillet to the body
  } pedicle;
  /// The right pedicle where it is not the left one's mirror image. Values as for a left one: x and convergence are
  /// those of its mirror image.
  std::optional<Pedicle> right_pedicle{};

  struct Canal {
    double width_mm = 20.0;    ///< of the hollow cut into body and arch; the pedicles bound the canal itself
    double front_mm = 15.2;    ///< y of its front wall
    double back_mm = 32.0;     ///< y of its back corner
    double roof_deg = 47.0;    ///< between the coronal plane and each side of its roof
    double rounding_mm = 6.0;  ///< of its corners
    double blend_mm = 1.7;     ///< rounding of the edges it cuts
  } canal;

  /// A tapering bar of elliptic section.
  struct Process {
    Vec3 root_mm, tip_mm;  ///< ends of its axis
    Vec3 thin_direction;   ///< along which it is thin
    double root_thickness_mm, tip_thickness_mm;
    double width_over_thickness;  ///< at least 1
    double blend_mm;              ///< reach of the fillet to its neighbours
  };
  Process transverse{{18.0, 28.2, 2.8}, {35.0, 31.8, 4.6}, {-0.25, 1.0, 0.1}, 5.4, 4.0, 2.1, 3.4};
  Process superior_articular{{18.2, 31.0, 3.0}, {19.6, 32.4, 10.8}, {-0.72, 0.69, 0.0}, 8.4, 7.6, 1.5, 2.3};
  Process inferior_articular{{11.0, 34.0, -8.0}, {13.2, 36.2, -20.6}, {0.62, -0.78, 0.0}, 8.6, 7.4, 1.7, 5.0};
  Process pars{{17.0, 30.8, 0.5}, {11.5, 34.0, -9.0}, {0.55, -0.83, 0.0}, 8.0, 8.0, 1.4, 2.4};

  struct Facet {
    double radius_mm = 15.0;  ///< of the cylinder that hollows the superior articular process
    double hollow_mm = 1.8;   ///< how deep it cuts
  } facet;

  struct Mammillary {
    Vec3 centre_mm{22.2, 34.2, 7.5};
    double radius_mm = 3.0;
    double blend_mm = 3.0;
  } mammillary;

  struct Lamina {
    Vec3 centre_mm{6.5, 34.2, -7.0};
    double slope_deg = 40.0;  ///< between the coronal plane and the plate, seen from above
    double lean_deg = 14.0;   ///< how far its lower edge is turned backward
    double length_mm = 17.0;  ///< from the middle to the pars
    double height_mm = 20.0;
    double thickness_mm = 6.5;
    double blend_mm = 3.5;
  } lamina;

  struct Spinous {
    /// Corners (y, z) of the plate seen from the side, convex, clockwise from the upper root.
    std::array<Eigen::Vector2d, 5> outline_mm{Eigen::Vector2d{31.0, 0.5}, Eigen::Vector2d{55.0, -2.0},
                                              Eigen::Vector2d{58.6, -7.0}, Eigen::Vector2d{57.2, -22.5},
                                              Eigen::Vector2d{31.0, -15.5}};
    double rounding_mm = 4.0;  ///< of the outline's corners
    double root_thickness_mm = 6.0;
    double tip_thickness_mm = 9.0;
    double blend_mm = 5.0;
  } spinous;

  struct Cortex {
    double hu = 1300.0;
    double body_wall_mm = 0.5;  ///< thickness of the shell
    double endplate_mm = 0.5;
    double pedicle_mm = 0.9;
    double posterior_mm = 1.0;
  } cortex;

  struct Cancellous {
    double body_hu = 150.0;         ///< mean
    double pedicle_hu = 240.0;      ///< mean
    double posterior_hu = 300.0;    ///< mean
    double texture_hu = 55.0;       ///< standard deviation of the texture
    double texture_scale_mm = 1.0;  ///< of its grains, across
    double texture_stretch = 1.8;   ///< of its grains, along z over across
    std::uint64_t texture_seed = 3;
  } cancellous;

  struct Placement {
    Vec3 position_mm = Vec3::Zero();   ///< of the vertebra's origin, patient LPS
    Vec3 rotation_deg = Vec3::Zero();  ///< about x, then y, then z of the patient
  } placement;
};

/// The rotation that Placement::rotation_deg stands for, and the turns that a rotation is made of.
Mat3 rotation_from_degrees(const Vec3& degrees);
Vec3 rotation_in_degrees(const Mat3& rotation);

/// Rejects values that are not finite, out of any reason, or contradict each other; names the value in the Error.
void check_anatomy(const VertebraAnatomy& anatomy);

}  // namespace spinaltap

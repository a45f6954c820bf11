#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "apps/link/link_message.h"
#include "core/base/geometry.h"
#include "core/registration/rigid_pose.h"
#include "core/tool/drill_bit.h"

// The border between SpinalTap's frame, patient LPS, and that of those on the link, patient RAS, as 3D Slicer has it:
// x and y change their signs. Everything on the link is RAS, everything behind it LPS.
namespace spinaltap {

Vec3 ras_from_lps(const Vec3& lps);
Vec3 lps_from_ras(const Vec3& ras);
Eigen::Vector3f ras_from_lps(const Eigen::Vector3f& lps);

/// A frame on the bit, in RAS: its origin the tip, its z axis the bit's, from the base to the tip; its x axis the
/// pose's side, or any across.
LinkTransform bit_in_ras(const Pose& pose_lps);

/// The patient's TRANSFORM of a registration of points that were measured in the reference's frame: as on the link,
/// RAS, which is LPS in a registration.
LinkTransform patient_in_ras(const RigidPose& ct_from_patient);

/// Where the tip lies in the tracked tool's own frame, and which way the bit points there.
struct ToolFrame {
  Vec3 tip_mm = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();  ///< unit, from the base to the tip
  Vec3 side = Vec3::UnitX();  ///< unit, across it: which way a plate's width lies
};
/// Throws Error on what is not finite, or no direction; brings the axis to length 1.
ToolFrame tool_frame(const Vec3& tip_mm, const Vec3& axis);
/// The bit's pose in LPS, of a tool in RAS.
Pose pose_in_lps(const LinkTransform& tool_in_ras, const ToolFrame& frame);

/// What is tracked.
enum class LinkDevice : std::uint8_t { tool, reference, patient };

enum class TrackingState : std::uint8_t {
  waiting,  ///< no tool has come yet
  ok,
  stale,   ///< the tool, or the reference, has not been heard of for too long
  invalid  ///< its sender says that it does not see it
};
/// "waiting", "ok", "stale", "invalid".
std::string_view name_of(TrackingState state);

struct TrackingOptions {
  double stale_s = 0.5;
  bool is_patient_tracked = false;  ///< else the patient's transform is a registration, which holds until the next
  bool needs_reference = false;     ///< there is no pose before the reference has come; else it is then the identity
  bool needs_patient = false;       ///< likewise
  ToolFrame frame = {};
  std::optional<RigidPose> registration = {};  ///< where the patient is until a transform of it comes
};

/// Where the tool is in the patient, of what three devices send: patient * reference^-1 * tool. Those that have not
/// come are the identity. Times are those of arrival on the host's monotonic clock: whatever senders' clocks do.
class Tracking {
 public:
  explicit Tracking(const TrackingOptions& options);

  void update(LinkDevice device, const LinkTransform& transform, bool is_valid, std::int64_t now_ns);
  /// Its sender says that it does not see it.
  void invalidate(LinkDevice device, std::int64_t now_ns);
  TrackingState state(std::int64_t now_ns) const;
  /// LPS; nothing but in TrackingState::ok.
  std::optional<Pose> pose(std::int64_t now_ns) const;

 private:
  struct Tracked {
    LinkTransform transform = LinkTransform::Identity();
    std::int64_t at_ns = 0;
    bool is_there = false;
    bool is_valid = false;
  };
  Tracked& of(LinkDevice device) { return tracked_[static_cast<std::size_t>(device)]; }
  const Tracked& of(LinkDevice device) const { return tracked_[static_cast<std::size_t>(device)]; }
  TrackingState state_of(LinkDevice device, bool is_needed, bool may_hold, std::int64_t now_ns) const;

  TrackingOptions options_;
  std::array<Tracked, 3> tracked_;
};

}  // namespace spinaltap

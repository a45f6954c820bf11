#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/session/drill_session.h"

namespace spinaltap::test {

/// A path through layers of bone that lie across it, far from the origin and oblique to all axes, and a session on it.
struct DrillBlock {
  /// CT number by depth along the path; NaN where there is no bone.
  using Layers = std::function<double(double depth_mm)>;
  using MakeEngine = std::unique_ptr<DrillEngine> (*)(PointVolume&, const DrillBit&, const Material&);

  explicit DrillBlock(const Layers& layers, double length_mm = 20.0,
                      const DrillBit& bit = twist_drill(3.0, 60.0, 118.0, 0.48), double spacing_mm = 0.1)
      : path{"block", Vec3(31.0, 212.0, -618.0),
             Vec3(31.0, 212.0, -618.0) + length_mm * Vec3(-0.36, -0.8, 0.48).normalized(), bit} {
    volumes.emplace_back(path, PointVolumeOptions{.radius_mm = 2.5, .spacing_mm = spacing_mm, .lead_in_mm = 2.0});
    fill_volume(volumes.front(),
                [&](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
                  for (std::size_t n = 0; n < points_mm.size(); ++n) {
                    const double value = layers((points_mm[n] - path.entry_mm).dot(path.direction()));
                    distance_mm[n] = value == value ? -1.0F : 1.0F;
                    hu[n] = value == value ? static_cast<float>(value) : 0.0F;
                  }
                });
  }

  std::unique_ptr<DrillSession> session(const SessionOptions& options = {}, const ClearanceField* clearances = nullptr,
                                        MakeEngine make_engine = make_ring_engine) {
    return std::make_unique<DrillSession>(path, volumes, make_engine(volumes.front(), path.bit, material), material,
                                          clearances, options);
  }
  Pose at(double depth_mm, const Vec3& aside_mm = Vec3::Zero()) const {
    return {path.entry_mm + depth_mm * path.direction() + aside_mm, path.direction()};
  }
  ToolInput input(double depth_mm, bool spindle_on = true) const { return {at(depth_mm), spindle_on, 0.001}; }

  DrillPath path;
  Material material;
  std::vector<PointVolume> volumes;
};

/// The events of one kind.
inline std::vector<SessionEvent> events_of(const DrillSession& session, EventKind kind) {
  std::vector<SessionEvent> found;
  for (const SessionEvent& event : session.events()) {
    if (event.kind == kind) found.push_back(event);
  }
  return found;
}

}  // namespace spinaltap::test

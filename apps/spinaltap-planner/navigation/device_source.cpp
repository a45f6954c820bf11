#include "apps/spinaltap-planner/navigation/device_source.h"

#include <utility>

#include "apps/report/text.h"
#include "apps/spinaltap-planner/slices/pane_geometry.h"
#include "core/base/text_writer.h"
#include "core/session/device/coupled_operator.h"
#include "core/session/device/open_device.h"

namespace spinaltap {
namespace {

/// A hand may come from anywhere: voxels, as coarse as those of `spinaltap link`.
void prepare_for_hand(SessionSetup& setup) {
  constexpr double kVoxelMm = 0.2;
  setup.options.has_device = true;
  setup.volume.spacing_mm = kVoxelMm;
}

/// The operator's device is another's: it asks that.
class SharedDevice final : public HapticDevice {
 public:
  explicit SharedDevice(std::shared_ptr<HapticDevice> device) : device_(std::move(device)) {}
  const std::string& name() const override { return device_->name(); }
  const DeviceLimits& limits() const override { return device_->limits(); }
  bool read(DeviceSample& sample) noexcept override { return device_->read(sample); }
  bool give(const Vec3& force_n, const Vec3& torque_n_mm) noexcept override {
    return device_->give(force_n, torque_n_mm);
  }

 private:
  std::shared_ptr<HapticDevice> device_;
};

}  // namespace

void DesktopSource::prepare(SessionSetup& setup) const { prepare_for_hand(setup); }

OperatorPlan DesktopSource::begin(const SessionSetup& setup, const Progress& /*progress*/) {
  OperatorPlan plan;
  plan.device = std::make_unique<SharedDevice>(device_);
  plan.rate_hz = device_->limits().rate_hz;
  plan.way.is_free = true;
  plan.words = {{"kind", "device"},
                {"device", device_->name()},
                {"force scale", short_text(kNavigationForceScale)},
                {"rate", short_text(plan.rate_hz) + " Hz"}};
  CoupledOptions coupled{.spindle = setup.options.spindle,
                         .lead_in_mm = setup.volume.lead_in_mm,
                         .longest_s = 1e6,
                         .end_button = kEndButton};
  coupled.coupling.force_scale = kNavigationForceScale;
  coupled.coupling.spindle_button = kSpindleButton;
  const PanePlane view = plane_down_path(setup.path, 0.0);
  DeviceMount mount;
  mount.turn << view.right, view.down, view.into();
  mount.place_mm = setup.path.entry_mm - setup.volume.lead_in_mm * view.into();
  coupled.mount = mount;
  plan.tool_operator = std::make_unique<CoupledOperator>(*plan.device, setup.path, coupled);
  return plan;
}

void DeviceSource::prepare(SessionSetup& setup) const { prepare_for_hand(setup); }

OperatorPlan DeviceSource::begin(const SessionSetup& setup, const Progress& /*progress*/) {
  OperatorChoice choice;
  choice.device = device_;
  choice.force_scale = kNavigationForceScale;
  choice.longest_s = 1e6;
  return choice.plan(setup.path, setup.volume.lead_in_mm, setup.options.spindle, false);
}

}  // namespace spinaltap

#pragma once

#include <memory>

#include "apps/spinaltap-planner/navigation/desktop_device.h"
#include "apps/spinaltap-planner/navigation/navigation_source.h"

namespace spinaltap {

/// What a device gives of the bone's force here, as `spinaltap drill` has it.
inline constexpr double kNavigationForceScale = 0.1;

/// Keyboard and mouse: a device of the program's own, coupled to the tool (CoupledOperator). Its coordinates are those
/// of the view down the path: right, down, into the bone.
class DesktopSource final : public NavigationSource {
 public:
  DesktopDevice& device() { return *device_; }

  std::string name() const override { return device_->name(); }
  void prepare(SessionSetup& setup) const override;
  OperatorPlan begin(const SessionSetup& setup, const Progress& progress) override;

 private:
  std::shared_ptr<DesktopDevice> device_ = std::make_shared<DesktopDevice>();
};

/// A device of a plug-in, or the simulated one: as open_device() has it.
class DeviceSource final : public NavigationSource {
 public:
  explicit DeviceSource(std::string device) : device_(std::move(device)) {}

  std::string name() const override { return device_; }
  void prepare(SessionSetup& setup) const override;
  OperatorPlan begin(const SessionSetup& setup, const Progress& progress) override;

 private:
  std::string device_;
};

}  // namespace spinaltap

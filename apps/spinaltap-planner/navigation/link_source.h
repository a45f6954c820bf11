#pragma once

#include <memory>

#include "apps/link/link_exchange.h"
#include "apps/spinaltap-planner/navigation/navigation_source.h"

namespace spinaltap {

/// A tool that is tracked elsewhere and comes over OpenIGTLink, as `spinaltap link` takes it: TRANSFORMs of tool,
/// reference and patient in, commands for the spindle, the bit's TRANSFORM, states and events out. A cycle each
/// millisecond takes the latest pose; between poses the tool stands. Where it is stale or not seen the input says
/// DeviceStatus::lost, and the spindle is off, also in the cycle in which it is back: what lies between is not cut.
/// The record has all of this.
class LinkSource final : public NavigationSource {
 public:
  LinkSource(LinkServerOptions server, TrackingOptions tracking);

  std::string name() const override { return name_; }
  void prepare(SessionSetup& setup) const override;
  /// Listens, or connects, and waits for the first pose of the tool.
  OperatorPlan begin(const SessionSetup& setup, const Progress& progress) override;
  void tell(const Session& session) override;
  void end() override;

 private:
  LinkServerOptions options_;
  TrackingOptions tracking_;
  std::string name_;
  std::shared_ptr<LinkServer> server_;
  LinkSender sender_;
};

/// A source that listens at a port, "18944", or at a port of a numeric address, "0.0.0.0:18944". Throws Error on other
/// words.
std::shared_ptr<LinkSource> listening_link(const std::string& address);
/// A source that connects to a server: "localhost:18944" or "localhost".
std::shared_ptr<LinkSource> connecting_link(const std::string& address);

}  // namespace spinaltap

#pragma once

#include <string>

#include "apps/report/operator_choice.h"
#include "core/base/progress.h"
#include "core/session/session_setup.h"
#include "vdb/sim/session.h"

namespace spinaltap {

/// What moves the tool of a navigation picture: a device, a link, a record. It has one hole at a time.
class NavigationSource {
 public:
  NavigationSource() = default;
  NavigationSource(const NavigationSource&) = delete;
  NavigationSource& operator=(const NavigationSource&) = delete;
  virtual ~NavigationSource() = default;

  /// For people: "keyboard and mouse".
  virtual std::string name() const = 0;
  /// What the session needs for it; `setup` is that of the chosen path.
  virtual void prepare(SessionSetup& setup) const = 0;
  /// Opens it, and waits until it says where the tool is: from any thread, cancelled by `progress`. Throws Error.
  virtual OperatorPlan begin(const SessionSetup& setup, const Progress& progress) = 0;
  /// After each cycle, in the thread that drills: what to tell others.
  virtual void tell(const Session& /*session*/) {}
  /// The hole is done: devices and ports are let go, those of the operator with it. Nothing happens a second time.
  virtual void end() {}
  /// A hand, or somebody elsewhere: nobody can have the same again but from its inputs.
  virtual bool is_live() const { return true; }
};

}  // namespace spinaltap

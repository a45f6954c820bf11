#pragma once

#include <memory>

#include "core/session/operator/force_controlled.h"
#include "core/session/operator/operator.h"
#include "core/session/operator/path_motion.h"

namespace spinaltap {

/// What moves a tool, before it begins: the same one may drill any number of sessions.
class PlannedOperator {
 public:
  PlannedOperator() = default;
  PlannedOperator(const PlannedOperator&) = delete;
  PlannedOperator& operator=(const PlannedOperator&) = delete;
  virtual ~PlannedOperator() = default;

  /// `spindle`: the session's.
  virtual std::unique_ptr<Operator> begin(const Spindle& spindle) const = 0;
};

}  // namespace spinaltap

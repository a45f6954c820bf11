#pragma once

#include <span>

#include "core/session/drill_session.h"
#include "core/session/operator/drilled_hole.h"
#include "core/session/session_setup.h"

namespace spinaltap {

/// Where a cycle's tool was, of a compliant one its real pose, and whether it cut: with the spindle off at no speed.
ToolMove cutting_move(const Cycle& cycle, const SessionOptions& options) noexcept;
/// What a cycle's input took: with the spindle off at no speed, as a session has it, and where a compliant tool was.
ToolInput cutting_input(const Cycle& cycle, const SessionOptions& options);
/// The hole that a session's inputs made.
DrilledHole hole_of(std::span<const ToolInput> inputs, const SessionSetup& setup);

}  // namespace spinaltap

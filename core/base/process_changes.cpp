#include "core/base/process_changes.h"

#include <atomic>

namespace spinaltap {
namespace {

std::atomic<ProcessChanges>& allowed() {
  static std::atomic<ProcessChanges> changes{ProcessChanges{}};
  return changes;
}

}  // namespace

void allow_process_changes(const ProcessChanges& changes) noexcept { allowed() = changes; }

ProcessChanges allowed_process_changes() noexcept { return allowed(); }

}  // namespace spinaltap

#include "core/base/process_changes.h"

#include <atomic>

namespace spinaltap {
namespace {

// One by one: a structure of both would need a library of its own with clang.
std::atomic<bool> silences_decoders{false};
std::atomic<bool> silences_hdf5_at_exit{false};

}  // namespace

void allow_process_changes(const ProcessChanges& changes) noexcept {
  silences_decoders = changes.silences_decoders;
  silences_hdf5_at_exit = changes.silences_hdf5_at_exit;
}

ProcessChanges allowed_process_changes() noexcept { return {silences_decoders, silences_hdf5_at_exit}; }

}  // namespace spinaltap

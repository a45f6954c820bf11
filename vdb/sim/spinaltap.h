#pragma once

/// All that a program needs to go from a CT to forces: `#include <spinaltap/spinaltap.h>`, link spinaltap::spinaltap.
/// docs/first-program.md begins with it.

#include "core/base/error.h"
#include "core/base/version.h"
#include "core/files/data_files.h"
#include "core/files/plan_file.h"
#include "core/session/operator/force_controlled.h"
#include "core/session/operator/path_motion.h"
#include "core/session/operator/recorded_motion.h"
#include "vdb/sim/bone.h"
#include "vdb/sim/replay.h"
#include "vdb/sim/session.h"
#include "vdb/sim/study.h"

#ifdef SPINALTAP_DATA_FOLDER  // an installed package's
namespace spinaltap {
// In each file that includes this: where nobody uses it, an inline one would not be there at all.
[[maybe_unused]] static const bool kHasDataFolder = add_data_folder(SPINALTAP_DATA_FOLDER);
}  // namespace spinaltap
#endif

#pragma once

#include <filesystem>
#include <vector>

#include "apps/spinaltap-planner/opened_bone.h"
#include "core/phantom/vertebra.h"
#include "core/session/operator/milling.h"

namespace spinaltap::test {

/// The phantom's vertebra, baked from its formulas into a file; made once.
const std::filesystem::path& phantom_file();
/// The same, opened once for all tests.
const std::shared_ptr<const OpenedBone>& phantom_bone();
/// The phantom's own planned paths: left, right.
std::vector<DrillPath> phantom_paths();

/// A folder with a CT of the phantom's spine, T11 to L2 with ribs, all four whole; made once.
const std::filesystem::path& spine_folder();

/// The left path with a ball burr of 4 mm, and a patch around its entry to mill: 4 x 4 mm, 1 mm below the surface.
DrillPath burr_path();
Milling entry_milling();

}  // namespace spinaltap::test

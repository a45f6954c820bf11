#pragma once

#include <filesystem>
#include <vector>

#include "apps/spinaltap-planner/opened_bone.h"
#include "core/phantom/vertebra.h"

namespace spinaltap::test {

/// The phantom's vertebra, baked from its formulas into a file; made once.
const std::filesystem::path& phantom_file();
/// The same, opened once for all tests.
const std::shared_ptr<const OpenedBone>& phantom_bone();
/// The phantom's own planned paths: left, right.
std::vector<DrillPath> phantom_paths();

}  // namespace spinaltap::test

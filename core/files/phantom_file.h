#pragma once

#include <filesystem>

#include "core/phantom/vertebra_anatomy.h"

namespace spinaltap {

/// Reads a phantom's anatomy from a JSON file like the shipped phantom/l3.json: one object per group of
/// VertebraAnatomy, with the names of its members as keys; a "source" text may stand in each. Missing keys keep their
/// default, those of a "right_pedicle" the left one's. Throws Error, which names file and key, on text that is not
/// JSON, unknown keys, wrong types, and values that check_anatomy() rejects.
VertebraAnatomy read_anatomy(const std::filesystem::path& path);

}  // namespace spinaltap

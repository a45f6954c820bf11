#pragma once

#include <filesystem>

#include "core/rbf/rbf_model.h"

namespace spinaltap {

/// Writes a radial basis function, bit for bit; docs/rbf-file.md describes each byte. `path` is a staged (temporary)
/// name. Throws Error when the model is not whole (check_model) and when the disk is full.
void write_rbf(const RbfModel& model, const std::filesystem::path& path);

/// Reads what write_rbf() wrote. Throws Error, naming the file, when it is another kind of file or version, is cut
/// short or damaged, or when a number is not finite.
RbfModel read_rbf(const std::filesystem::path& path);

}  // namespace spinaltap

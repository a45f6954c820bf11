#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/phantom/scanner.h"
#include "core/phantom/spine_truth.h"
#include "core/phantom/vertebra_truth.h"

namespace spinaltap {

/// Write truth.json of a phantom: how it was scanned, and where its parts are, patient LPS. `ct_hash`: of the CT that
/// the scan made (CtVolume::source_hash).
void write_truth(const std::optional<VertebraTruth>& truth, const ScanOptions& scan, const std::string& ct_hash,
                 const std::filesystem::path& file);
void write_truth(const SpineTruth& truth, const ScanOptions& scan, const std::string& ct_hash,
                 const std::filesystem::path& file);

}  // namespace spinaltap

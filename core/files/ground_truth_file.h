#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/phantom/scanner.h"
#include "core/phantom/spine_ground_truth.h"
#include "core/phantom/vertebra_ground_truth.h"

namespace spinaltap {

/// Write ground_truth.json of a phantom: how it was scanned, and where its parts are, patient LPS. `ct_hash`: of the CT
/// that the scan made (CtVolume::source_hash).
void write_ground_truth(const std::optional<VertebraGroundTruth>& ground_truth, const ScanOptions& scan,
                        const std::string& ct_hash, const std::filesystem::path& file);
void write_ground_truth(const SpineGroundTruth& ground_truth, const ScanOptions& scan, const std::string& ct_hash,
                        const std::filesystem::path& file);

}  // namespace spinaltap

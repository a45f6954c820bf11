#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/ct/ct_volume.h"

namespace spinaltap {

/// What CtVolume::frame_hash has for a FrameOfReferenceUID; empty for an empty one.
std::string hash_of_frame(const std::string& uid);

/// What speaks against a DICOM label map, segmentation or structure set, that names a frame of reference other than its
/// CT's: positions of two frames cannot be compared (PS3.3, C.7.4.1). Nothing where either names none, and for other
/// files. Throws Error on a damaged DICOM file.
std::optional<std::string> warning_of_frame(const std::filesystem::path& labels, const CtVolume& ct);

}  // namespace spinaltap

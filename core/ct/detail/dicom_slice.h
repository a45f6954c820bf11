#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/ct/detail/dicom_header.h"

namespace spinaltap {

/// What padding becomes, which was not measured.
constexpr std::int16_t kAirHu = -1024;

/// Throws Error for what is not one grey picture, states no rescaling, or holds too few bytes for its size: before
/// memory is taken for it.
/// `takes_stored`: values without a rescaling are taken as they are stored.
void check_dicom_slice(const DicomHeader& header, bool takes_stored = false);

/// The lowest and the highest CT number that padding takes from measured values; nothing where there is none.
std::optional<std::array<double, 2>> padded_hu(const DicomHeader& header);

/// Decodes the pixels of one slice into `hu` (header.columns * header.rows values, columns fastest), rescaled, rounded
/// and clamped to 16 bit; padding becomes air. Safe to call from many threads. Throws Error for what is not one grey
/// picture or cannot be decoded.
void decode_dicom_slice(const DicomHeader& header, std::span<std::int16_t> hu, bool takes_stored = false);

}  // namespace spinaltap

#pragma once

#include <string>
#include <string_view>

namespace spinaltap {

/// A UID "2.25.<number>" (PS3.5, B.2) that depends on `content` and nothing else: 128 bits of its hash, marked as a
/// UUID of version 8.
std::string dicom_uid_of(std::string_view content);

}  // namespace spinaltap

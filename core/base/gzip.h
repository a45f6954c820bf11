#pragma once

#include <string>
#include <string_view>

namespace spinaltap {

/// Data in gzip's format (RFC 1952) without time or name, so that the same data give the same bytes.
std::string gzip(std::string_view data);

}  // namespace spinaltap

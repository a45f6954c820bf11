#pragma once

#include <string>
#include <string_view>

namespace spinaltap {

/// Data in gzip's format (RFC 1952) without time or name, so that the same data give the same bytes.
std::string gzip(std::string_view data);

/// What a gzip stream holds. Throws Error when it is damaged, or holds other than `size` bytes; no more memory than
/// that is taken.
std::string gunzip(std::string_view stream, std::size_t size);

}  // namespace spinaltap

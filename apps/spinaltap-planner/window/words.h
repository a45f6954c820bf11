#pragma once

#include <QString>
#include <string>

namespace spinaltap {

inline QString text_of(const std::string& text) {
  return QString::fromUtf8(text.data(), static_cast<int>(text.size()));
}

}  // namespace spinaltap

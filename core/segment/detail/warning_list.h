#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/segment/level_warnings.h"

namespace spinaltap {

/// 0 at `fine` and on its side, 1 at `bad` and beyond, even between them.
inline double ramp(double value, double fine, double bad) {
  return std::clamp((value - fine) / (bad - fine), 0.0, 1.0);
}

/// What speaks against a vertebra, as it is found.
class WarningList {
 public:
  static constexpr double kMin = 0.1;  ///< less is not worth a word

  void add(double severity, std::string text, const std::optional<Vec3>& where_mm = std::nullopt) {
    if (severity >= kMin) note(severity, std::move(text), where_mm);
  }
  /// Worth a word however small.
  void note(double severity, std::string text, const std::optional<Vec3>& where_mm) {
    list_.push_back({std::move(text), severity, where_mm});
  }
  std::vector<LevelWarning> take() { return std::move(list_); }

 private:
  std::vector<LevelWarning> list_;
};

}  // namespace spinaltap

#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/phantom/spine.h"

namespace spinaltap::test {

/// Several vertebrae as one body to scan, as they stand.
class StackedVertebrae : public Spine {
 public:
  explicit StackedVertebrae(const std::vector<VertebraAnatomy>& anatomies) : Spine(parts_of(anatomies)) {}
  /// `count` copies of one vertebra, `step_mm` apart along its own axis, the middle one at the origin; the lowest
  /// first.
  StackedVertebrae(int count, double step_mm, const Vec3& rotation_deg)
      : StackedVertebrae(copies(count, step_mm, rotation_deg)) {}

  const Vertebra& operator[](std::size_t n) const { return *part(n).vertebra; }

 private:
  static std::vector<SpinePart> parts_of(const std::vector<VertebraAnatomy>& anatomies) {
    std::vector<SpinePart> parts;
    for (const VertebraAnatomy& anatomy : anatomies) {
      SpinePart part;
      part.label = static_cast<std::uint8_t>(static_cast<int>(Level::kL5) - static_cast<int>(parts.size()));
      part.vertebra = std::make_shared<const Vertebra>(anatomy);
      part.solid = part.vertebra;
      parts.push_back(std::move(part));
    }
    return parts;
  }
  static std::vector<VertebraAnatomy> copies(int count, double step_mm, const Vec3& rotation_deg) {
    std::vector<VertebraAnatomy> anatomies;
    for (int n = 0; n < count; ++n) {
      VertebraAnatomy anatomy;
      anatomy.placement.rotation_deg = rotation_deg;
      anatomy.placement.position_mm = (n - count / 2) * step_mm * rotation_from_degrees(rotation_deg).col(2);
      anatomies.push_back(anatomy);
    }
    return anatomies;
  }
};

}  // namespace spinaltap::test

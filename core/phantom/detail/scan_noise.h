#pragma once

#include <vector>

#include "core/phantom/scanner.h"

namespace spinaltap {

/// The noise of a virtual scan: white noise per pixel, blurred in the slice like the image, of the deviation asked for.
class ScanNoise {
 public:
  explicit ScanNoise(const ScanOptions& options);

  /// columns * rows values, HU. The same whichever thread asks.
  std::vector<float> slice(int slice) const;

 private:
  const ScanOptions options_;
  std::vector<float> kernel_;  ///< along one axis; its squares sum to 1, which keeps the deviation
};

}  // namespace spinaltap

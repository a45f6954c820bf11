#include "core/ct/label_file.h"

#include <cmath>
#include <cstring>

#include "core/base/error.h"

namespace spinaltap::detail {
namespace {

template <class Number>
void find_in(std::span<const char> bytes, double slope, double intercept, int label, LabelVoxels& voxels) {
  const std::size_t count = bytes.size() / sizeof(Number);
  std::vector<double> values(count);
  for (std::size_t n = 0; n < count; ++n) {
    Number number;
    std::memcpy(&number, bytes.data() + n * sizeof number, sizeof number);
    values[n] = static_cast<double>(number) * slope + intercept;
  }
  find_label(values, label, voxels);
}

}  // namespace

std::size_t bytes_of(Stored stored) {
  switch (stored) {
    case Stored::kInt8:
    case Stored::kUint8:
      return 1;
    case Stored::kInt16:
    case Stored::kUint16:
      return 2;
    case Stored::kInt32:
    case Stored::kUint32:
    case Stored::kFloat32:
      return 4;
    default:
      return 8;
  }
}

void find_label(Stored stored, std::span<const char> bytes, double slope, double intercept, int label,
                LabelVoxels& voxels) {
  switch (stored) {
    case Stored::kInt8:
      return find_in<std::int8_t>(bytes, slope, intercept, label, voxels);
    case Stored::kUint8:
      return find_in<std::uint8_t>(bytes, slope, intercept, label, voxels);
    case Stored::kInt16:
      return find_in<std::int16_t>(bytes, slope, intercept, label, voxels);
    case Stored::kUint16:
      return find_in<std::uint16_t>(bytes, slope, intercept, label, voxels);
    case Stored::kInt32:
      return find_in<std::int32_t>(bytes, slope, intercept, label, voxels);
    case Stored::kUint32:
      return find_in<std::uint32_t>(bytes, slope, intercept, label, voxels);
    case Stored::kInt64:
      return find_in<std::int64_t>(bytes, slope, intercept, label, voxels);
    case Stored::kUint64:
      return find_in<std::uint64_t>(bytes, slope, intercept, label, voxels);
    case Stored::kFloat32:
      return find_in<float>(bytes, slope, intercept, label, voxels);
    case Stored::kFloat64:
      return find_in<double>(bytes, slope, intercept, label, voxels);
  }
}

void find_label(std::span<const double> values, int label, LabelVoxels& voxels) {
  long long last = 0;
  for (const double value : values) {
    const bool is_label = std::abs(value) < 1e15;  // false also for what is not a number
    const long long found = is_label ? std::llround(value) : 0;
    if (found != last && found != 0) voxels.present.insert(found);
    last = found;
    voxels.has_label.push_back(is_label && found == label ? 1 : 0);
  }
}

void check_transform(const LabelVoxels& voxels, const std::string& what) {
  const double volume_mm3 = std::abs(voxels.index_to_patient.determinant());
  if (!voxels.index_to_patient.allFinite() || !voxels.origin_mm.allFinite() || !(volume_mm3 > 1e-12)) {
    fail("expected a transform that gives voxels a volume, found one that does not in ", what);
  }
}

}  // namespace spinaltap::detail

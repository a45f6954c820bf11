#include "core/ct/detail/dicom_agreement.h"

#include <algorithm>
#include <map>

#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

template <class Read>
void compare(std::span<const DicomHeader> slices, const char* name, const Read& read, std::vector<std::string>& lines) {
  using Value = decltype(read(slices.front()));
  std::map<Value, std::size_t> counts;
  for (const DicomHeader& slice : slices) ++counts[read(slice)];
  if (counts.size() < 2) return;
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (2 * most->second < slices.size()) return;
  const auto other =
      std::find_if(counts.begin(), counts.end(), [&](const auto& one) { return one.first != most->first; });
  lines.push_back(joined("slices disagree in ", name, ": ", most->first, " in ", most->second, " of ", slices.size(),
                         ", ", other->first, " in ", other->second, counts.size() > 2 ? ", and others" : ""));
}

double first_of(const std::vector<double>& values, double otherwise) {
  return values.empty() ? otherwise : values.front();
}

}  // namespace

std::vector<std::string> disagreements_of(std::span<const DicomHeader> slices) {
  std::vector<std::string> lines;
  if (slices.empty()) return lines;
  compare(
      slices, "RescaleSlope", [](const DicomHeader& h) { return first_of(h.rescale_slope, 1.0); }, lines);
  compare(
      slices, "RescaleIntercept", [](const DicomHeader& h) { return first_of(h.rescale_intercept, 0.0); }, lines);
  compare(
      slices, "PixelRepresentation", [](const DicomHeader& h) { return h.is_signed ? 1 : 0; }, lines);
  compare(
      slices, "BitsStored", [](const DicomHeader& h) { return h.bits_stored; }, lines);
  compare(
      slices, "PixelPaddingValue",
      [](const DicomHeader& h) { return h.padding ? std::to_string(*h.padding) : std::string("none"); }, lines);
  return lines;
}

bool has_rescale_type(std::span<const DicomHeader> slices, const char* type) {
  return std::any_of(slices.begin(), slices.end(),
                     [&](const DicomHeader& slice) { return slice.rescale_type == type; });
}

}  // namespace spinaltap

#include "core/ct/made_up_slices.h"

#include <algorithm>

#include "core/base/text_fields.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

constexpr const char* kMadeUp = "made_up_slices_mm";

}  // namespace

bool MadeUpSlices::holds(const Vec3& p_mm, double reach_mm) const {
  const double along_mm = normal.dot(p_mm);
  return std::any_of(slabs_mm.begin(), slabs_mm.end(), [&](const Interval& slab) {
    return along_mm + reach_mm > slab.low && along_mm - reach_mm < slab.high;
  });
}

void add_made_up(const MadeUpSlices& slices, std::map<std::string, std::string>& metadata) {
  if (slices.slabs_mm.empty()) return;
  TextWriter text(9);  // micrometres of a patient's metre
  text << slices.normal.x() << ' ' << slices.normal.y() << ' ' << slices.normal.z();
  for (const Interval& slab : slices.slabs_mm) text << ' ' << slab.low << ' ' << slab.high;
  metadata[kMadeUp] = text.str();
}

std::optional<MadeUpSlices> made_up_in(const std::map<std::string, std::string>& metadata) {
  const auto found = metadata.find(kMadeUp);
  if (found == metadata.end()) return std::nullopt;
  const std::optional<std::vector<double>> numbers = parse_numbers(found->second);
  if (!numbers || numbers->size() < 5 || numbers->size() % 2 == 0) return std::nullopt;
  MadeUpSlices slices;
  slices.normal = Vec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
  for (std::size_t n = 3; n < numbers->size(); n += 2) slices.slabs_mm.push_back({(*numbers)[n], (*numbers)[n + 1]});
  return slices;
}

}  // namespace spinaltap

#include <charconv>
#include <string_view>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/ct/detail/label_file.h"
#include "core/ct/detail/nifti_volume.h"

namespace spinaltap::detail {

void add_names_of_label_table(const std::string& xml, const std::filesystem::path& file,
                              std::map<long long, std::string>& names) {
  constexpr std::string_view kOpen = "<Label ";
  constexpr std::string_view kKey = "Key=\"";
  constexpr std::string_view kClose = "</Label>";
  constexpr std::string_view kCdata = "<![CDATA[";
  constexpr std::string_view kCdataEnd = "]]>";
  constexpr std::size_t kMax = 70'000;  // labels; a file of more is not one that people made
  const std::string_view text = xml;
  for (std::size_t at = text.find(kOpen); at != text.npos && names.size() < kMax; at = text.find(kOpen, at + 1)) {
    const std::size_t head_end = text.find('>', at);
    const std::size_t close = text.find(kClose, at);
    const std::size_t key = text.find(kKey, at);
    if (close == text.npos || !(key < head_end && head_end < close)) continue;
    long long number = 0;
    const char* const digits = text.data() + key + kKey.size();
    const auto [end, error] = std::from_chars(digits, text.data() + head_end, number);
    if (error != std::errc{} || *end != '"') continue;
    std::string_view name = text.substr(head_end + 1, close - head_end - 1);
    if (name.starts_with(kCdata) && name.ends_with(kCdataEnd)) {
      name = name.substr(kCdata.size(), name.size() - kCdata.size() - kCdataEnd.size());
    }
    const auto [there, is_new] = names.emplace(number, name);
    if (!is_new && there->second != name) {
      fail("expected one name a label, found ", in_quotes(there->second), " and ", in_quotes(name), " for label ",
           number, " in ", file.string());
    }
  }
}

LabelFile read_nifti_labels(const std::filesystem::path& file, NiftiAffine affine,
                            const std::function<void(const LabelFile&)>& begin, const TakeLabels& take) {
  const NiftiVolume nifti(file, affine);
  LabelFile labels;
  labels.size = nifti.size();
  labels.index_to_patient = nifti.index_to_patient();
  labels.origin_mm = nifti.origin_mm();
  labels.warnings = nifti.warnings();
  if (begin) begin(labels);
  nifti.read_values(take);
  for (const std::string& extension : nifti.read_extensions()) add_names_of_label_table(extension, file, labels.names);
  return labels;
}

}  // namespace spinaltap::detail

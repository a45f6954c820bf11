#include "core/ct/detail/dicom_labels.h"

#include <algorithm>
#include <array>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/ct/detail/dicom_values.h"
#include "core/ct/detail/label_names.h"

namespace spinaltap::detail {

namespace fs = std::filesystem;

DicomKind dicom_kind_of(const fs::path& file) {
  DicomElementWalker walker;
  if (!walker.open(file)) return DicomKind::kNone;
  std::string sop_class;
  try {
    for (DicomElement element; walker.next(element) && element.tag <= 0x00080016;) {
      if (element.tag == 0x00020010) {
        walker.set_transfer_syntax(dicom_text(walker.value(element)));
      } else if (element.tag == 0x00020002 || element.tag == 0x00080016) {
        const std::string found = dicom_text(walker.value(element));
        if (!found.empty()) sop_class = found;
      } else {
        walker.skip(element);
      }
    }
  } catch (const Error&) {
    return DicomKind::kOther;  // damaged: who reads it whole says how
  }
  constexpr std::string_view kStorage = "1.2.840.10008.5.1.4.1.1.";
  if (!sop_class.starts_with(kStorage)) return DicomKind::kOther;
  const std::string_view kind = std::string_view(sop_class).substr(kStorage.size());
  if (kind == "66.4") return DicomKind::kSegmentation;
  if (kind == "66.5") return DicomKind::kSurfaceSegmentation;
  if (kind == "66.7") return DicomKind::kLabelMapSegmentation;
  return kind == "481.3" ? DicomKind::kStructureSet : DicomKind::kOther;
}

DicomCode read_code(DicomElementWalker& walker, const DicomElement& sequence) {
  DicomCode code;
  walker.items(sequence, [&](std::size_t item, const DicomElement& element) {
    std::string* to = element.tag == 0x00080100 || element.tag == 0x00080119 ? &code.value
                      : element.tag == 0x00080102                            ? &code.scheme
                      : element.tag == 0x00080104                            ? &code.meaning
                                                                             : nullptr;
    if (item > 0 || to == nullptr) return walker.skip(element);
    *to = dicom_text(walker.value(element));
  });
  return code;
}

std::string name_of_segment(const DicomSegment& segment, const fs::path& file) {
  struct Witness {
    const char* what;
    Level level;
  };
  const Level by_type = level_of_code(segment.type);
  const bool is_bone = by_type != Level::kNone || segment.type.value.empty() || is_any_bone_code(segment.type);
  const Level by_region = is_bone ? level_of_code(segment.region) : Level::kNone;
  const Level by_label = level_in_name(segment.label).value_or(Level::kNone);
  const Level by_description = level_in_name(segment.description).value_or(Level::kNone);
  const Witness* first = nullptr;
  const std::array<Witness, 4> all{
      {{"code", by_type}, {"region", by_region}, {"name", by_label}, {"description", by_description}}};
  for (const Witness& one : all) {
    if (one.level == Level::kNone) continue;
    if (first == nullptr) first = &one;
    if (one.level == first->level) continue;
    fail("expected a segment whose codes and names are of one vertebra, found segment ", segment.number, " with the ",
         first->what, " of ", level_name(first->level), " and the ", one.what, " of ", level_name(one.level), " in ",
         file.string());
  }
  const std::string& text =
      by_label == Level::kNone && by_description != Level::kNone ? segment.description : segment.label;
  const bool is_coded = by_type != Level::kNone || by_region != Level::kNone;
  // "S1" may be a part of the sacrum: the text says more than the level.
  if (!is_coded || level_in_name(text) == Level::kSacrum) return text;
  return level_name(first->level);
}

std::optional<std::string> doubt_of_segment(const DicomSegment& segment) {
  if (!is_other_code(segment.type)) return std::nullopt;
  for (const std::string& text : {segment.label, segment.description}) {
    if (!level_in_name(text)) continue;
    return joined("segment ", segment.number, " is named ", in_quotes(text), ", but its type is coded as ",
                  in_quotes(segment.type.meaning), " (", segment.type.scheme, " ", segment.type.value,
                  "): it may be no vertebra");
  }
  return std::nullopt;
}

LabelPainter::LabelPainter(std::size_t voxels, std::map<long long, std::string> names)
    : labels_(voxels, 0), names_(std::move(names)), is_vertebra_(65536, false) {
  for (const auto& [number, name] : names_) {
    if (number > 0 && number < 65536) is_vertebra_[static_cast<std::size_t>(number)] = level_in_name(name).has_value();
  }
}

void LabelPainter::put(std::size_t voxel, std::uint16_t label, std::uint8_t fraction) {
  if (fraction < 255 && fractions_.empty()) fractions_.assign(labels_.size(), 255);
  std::uint16_t& there = labels_[voxel];
  if (there == label) {
    if (!fractions_.empty()) fractions_[voxel] = std::max(fractions_[voxel], fraction);
    return;
  }
  if (there != 0) {
    const bool both = is_vertebra_[there] == is_vertebra_[label];
    const bool is_larger = !fractions_.empty() && fraction > fractions_[voxel];
    const bool is_equal = fractions_.empty() || fraction == fractions_[voxel];
    // Parts of one voxel may be of two vertebrae; the whole of it may not.
    if (both && is_vertebra_[label] && is_equal && fraction == 255) {
      if (shared_++ == 0) {
        first_shared_ = there;
        second_shared_ = label;
      }
    }
    if (both ? !is_larger : is_vertebra_[there]) return;
  }
  there = label;
  if (!fractions_.empty()) fractions_[voxel] = fraction;
}

void LabelPainter::check_shared(const fs::path& file) const {
  if (shared_ == 0) return;
  const auto called = [&](std::uint16_t label) {
    const auto name = names_.find(label);
    return std::to_string(label) + (name == names_.end() ? "" : " (" + shown(name->second) + ")");
  };
  fail("expected vertebrae that do not overlap, found ", shared_, shared_ == 1 ? " voxel" : " voxels",
       " in two of them, the first in segments ", called(first_shared_), " and ", called(second_shared_), " of ",
       file.string(), " (one can be read alone, by its number)");
}

void LabelPainter::give_to(const TakeLabels& take) const {
  constexpr std::size_t kChunk = 65536;
  std::vector<double> values;
  for (std::size_t done = 0; done < labels_.size(); done += values.size()) {
    values.assign(labels_.begin() + static_cast<std::ptrdiff_t>(done),
                  labels_.begin() + static_cast<std::ptrdiff_t>(std::min(done + kChunk, labels_.size())));
    take(values);
  }
}

}  // namespace spinaltap::detail

#include "core/ct/label_frame.h"

#include <algorithm>
#include <vector>

#include "core/base/hash.h"
#include "core/ct/detail/dicom_elements.h"
#include "core/ct/detail/dicom_labels.h"
#include "core/ct/detail/dicom_values.h"

namespace spinaltap {
namespace {

constexpr std::uint32_t kFrameOfReferenceUid = 0x00200052;
constexpr std::uint32_t kReferencedFrames = 0x30060010;  // ReferencedFrameOfReferenceSequence of a structure set

/// All that a DICOM label map names.
std::vector<std::string> frames_of(const std::filesystem::path& file) {
  std::vector<std::string> frames;
  const detail::DicomKind kind = detail::dicom_kind_of(file);
  if (kind == detail::DicomKind::kNone || kind == detail::DicomKind::kOther) return frames;
  DicomElementWalker walker;
  if (!walker.open(file)) return frames;
  for (DicomElement element; walker.next(element);) {
    if (element.tag > kReferencedFrames) break;  // elements come in the order of their tags
    if (element.tag == 0x00020010) {
      walker.set_transfer_syntax(dicom_text(walker.value(element)));
    } else if (element.tag == kFrameOfReferenceUid) {
      frames.push_back(dicom_text(walker.value(element)));
    } else if (element.tag == kReferencedFrames) {
      walker.items(element, [&](std::size_t, const DicomElement& part) {
        if (part.tag == kFrameOfReferenceUid) {
          frames.push_back(dicom_text(walker.value(part)));
        } else {
          walker.skip(part);
        }
      });
    } else {
      walker.skip(element);
    }
  }
  std::erase(frames, "");
  return frames;
}

}  // namespace

std::string hash_of_frame(const std::string& uid) {
  if (uid.empty()) return {};
  WordHash64 hash;
  hash.add(uid.data(), uid.size());
  return hash.hex();
}

std::optional<std::string> warning_of_frame(const std::filesystem::path& labels, const CtVolume& ct) {
  if (ct.frame_hash.empty()) return std::nullopt;
  const std::vector<std::string> frames = frames_of(labels);
  const auto is_cts = [&](const std::string& frame) { return hash_of_frame(frame) == ct.frame_hash; };
  if (frames.empty() || std::any_of(frames.begin(), frames.end(), is_cts)) return std::nullopt;
  return "its FrameOfReferenceUID is not the CT's: it may be of another scan";
}

}  // namespace spinaltap

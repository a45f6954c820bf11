#include "core/ct/detail/volume_file.h"

#include <array>
#include <cmath>
#include <fstream>
#include <string_view>

#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap::detail {
namespace {

namespace fs = std::filesystem;

/// The first bytes of a regular file; a FIFO is not opened, which would wait for a writer.
std::string first_bytes(const fs::path& file) {
  constexpr std::size_t kEnough = 4096;  // for a MetaImage's first lines, comments among them
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return {};
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(kEnough, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

/// MetaImage has no magic number: its first lines name what every one of them has.
bool is_meta_image(const std::string& bytes) {
  const auto begins_line = [&](std::string_view key) {
    for (std::size_t at = bytes.find(key); at != std::string::npos; at = bytes.find(key, at + 1)) {
      const std::size_t after = bytes.find_first_not_of(" \t", at + key.size());
      const bool is_key = after != std::string::npos && (bytes[after] == '=' || bytes[after] == ':');
      if (is_key && (at == 0 || bytes[at - 1] == '\n')) return true;
    }
    return false;
  };
  return begins_line("NDims") && begins_line("DimSize");
}

}  // namespace

std::size_t VolumeFile::voxel_count() const {
  return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
}

VolumeFormat volume_format_of(const fs::path& file) {
  const std::string name = lower_case(file.filename().string());
  std::error_code error;
  if (fs::is_directory(file, error)) return VolumeFormat::kNone;
  const std::string bytes = first_bytes(file);
  if (bytes.starts_with("NRRD")) return VolumeFormat::kNrrd;
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return VolumeFormat::kNifti;
  if (is_meta_image(bytes)) return VolumeFormat::kMetaImage;
  // Damaged ones, and such as are missing, are said to be that and not "unknown".
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return VolumeFormat::kNrrd;
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return VolumeFormat::kMetaImage;
  return VolumeFormat::kNone;
}

VolumeFile open_volume_file(const fs::path& file, VolumeFormat format) {
  return format == VolumeFormat::kMetaImage ? open_meta_image(file) : open_nrrd(file);
}

void check_placed(const VolumeFile& volume, const fs::path& file) {
  constexpr std::size_t kMaxVoxels = std::size_t{1} << 30;
  std::size_t voxels = 1;
  for (const int size : volume.size) {
    if (size < 1 || static_cast<std::size_t>(size) > kMaxVoxels / voxels) {
      fail("expected at most ", kMaxVoxels, " voxels, found ", volume.size[0], " x ", volume.size[1], " x ",
           volume.size[2], " in ", file.string());
    }
    voxels *= static_cast<std::size_t>(size);
  }
  const double volume_mm3 = std::abs(volume.index_to_patient.determinant());
  if (!volume.index_to_patient.allFinite() || !volume.origin_mm.allFinite() || !(volume_mm3 > 1e-12)) {
    fail("expected directions of ", volume.format, " that give voxels a volume, and a place, found others in ",
         file.string());
  }
}

}  // namespace spinaltap::detail

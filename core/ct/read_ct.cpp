#include "core/ct/read_ct.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <string_view>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/ct/detail/dicom_header.h"
#include "core/ct/detail/dicom_labels.h"
#include "core/ct/detail/nifti_read.h"
#include "core/ct/detail/volume_file.h"
#include "core/ct/dicom_read.h"
#include "core/ct/hu_check.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWhatIsRead =
    "a folder with DICOM images, a multi-frame DICOM file, NIfTI (.nii, .nii.gz), NRRD (.nrrd, .nhdr) or MetaImage "
    "(.mha, .mhd)";

/// A kind of file that people try and that holds no CT that can be read, and what to do with it.
struct Foreign {
  std::string_view magic;  ///< what it begins with; empty: by the ending
  std::size_t at;          ///< where that stands, bytes from the start
  std::string_view ending;
  std::string_view what;
  std::string_view advice;
};

constexpr std::string_view kUnpack = "unpack it and give the folder";
constexpr std::string_view kPair =
    "an Analyze header does not say which side is left; of a NIfTI pair make one .nii file, as nifti_tool or 3D Slicer "
    "do";
constexpr std::string_view kConvert =
    "open it in the program it is from, or in 3D Slicer, and save it as .nrrd or .nii.gz";
constexpr std::string_view kPicture = "a picture holds no CT numbers: give the DICOM images that it was made from";

constexpr std::array<Foreign, 25> kForeign{{
    {"PK\3\4", 0, "", "a ZIP archive", kUnpack},
    {"\x1f\x8b", 0, "", "a gzip file that is no .nii.gz", "unpack it; a packed NIfTI file's name ends in .nii.gz"},
    {"7z\xbc\xaf", 0, "", "a 7z archive", kUnpack},
    {"Rar!", 0, "", "a RAR archive", kUnpack},
    {"BZh", 0, "", "a bzip2 file", kUnpack},
    {"\xfd"
     "7zXZ",
     0, "", "an xz file", kUnpack},
    {"ustar", 257, "", "a tar archive", kUnpack},
    {"ni1", 344, "", "the header of a NIfTI pair", kPair},
    {"\x89PNG", 0, "", "a PNG picture", kPicture},
    {"\xff\xd8\xff", 0, "", "a JPEG picture", kPicture},
    {"II*", 0, "", "a TIFF picture", kPicture},
    {"MM\0*", 0, "", "a TIFF picture", kPicture},
    {"# vtk DataFile", 0, "", "a VTK file", kConvert},
    {"CDF", 0, "", "a MINC file", kConvert},
    {"", 0, ".hdr", "the header of an Analyze or NIfTI pair", kPair},
    {"", 0, ".img", "the voxels of an Analyze or NIfTI pair", kPair},
    {"", 0, ".raw", "voxels without a header",
     "write a header beside it (.nhdr or .mhd) that says sizes, type and place"},
    {"", 0, ".bin", "voxels without a header",
     "write a header beside it (.nhdr or .mhd) that says sizes, type and place"},
    {"", 0, ".vti", "a VTK file", kConvert},
    {"", 0, ".mnc", "a MINC file", kConvert},
    {"", 0, ".mgz", "a FreeSurfer volume", kConvert},
    {"", 0, ".mgh", "a FreeSurfer volume", kConvert},
    {"", 0, ".stl", "a mesh", "give the CT that it was made from"},
    {"", 0, ".mat", "a MATLAB file", kConvert},
    {"", 0, ".npy", "a NumPy array", kConvert},
}};

/// Says what a file is that is none that we read, as far as that can be seen.
[[noreturn]] void reject_foreign(const fs::path& file) {
  std::string bytes(512, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  const std::string name = lower_case(file.filename().string());
  for (const Foreign& foreign : kForeign) {
    const bool is_one =
        foreign.magic.empty()
            ? name.ends_with(foreign.ending)
            : bytes.size() >= foreign.at && std::string_view(bytes).substr(foreign.at).starts_with(foreign.magic);
    if (is_one) {
      fail("expected a CT as ", kWhatIsRead, ", found ", foreign.what, ": ", file.string(), " (", foreign.advice, ")");
    }
  }
  fail("expected a CT as ", kWhatIsRead, ", found ", bytes.empty() ? "an empty file" : "another file", ": ",
       file.string());
}

CtVolume read_any(const fs::path& path, const CtReadOptions& options, const Progress& progress) {
  const detail::VolumeFormat format = detail::volume_format_of(path);
  if (format == detail::VolumeFormat::kNone) {
    check_ct_file(path);
    return read_dicom(path,
                      {.series = options.series,
                       .stack = options.stack,
                       .takes_stored = !options.hu.is_none(),
                       .resample = options.resample},
                      progress);
  }
  if (!options.series.empty() || options.stack != 0) {
    fail("expected no series for a file that holds one CT, found ",
         options.series.empty() ? "a stack" : in_quotes(options.series), " for ", path.string());
  }
  if (format == detail::VolumeFormat::kNifti) {
    CtVolume ct = read_nifti_ct(path, options.affine, progress);
    if (options.affine != NiftiAffine::automatic) {
      ct.choices["nifti_affine"] = options.affine == NiftiAffine::sform ? "sform, as was said" : "qform, as was said";
    }
    return ct;
  }
  return detail::ct_of_volume(detail::open_volume_file(path, format), path, progress);
}

CtVolume changed(CtVolume ct, const HuChange& change) {
  if (!std::isfinite(change.offset) || !std::isfinite(change.scale) || change.scale == 0.0) {
    fail("expected a scale other than 0 and an offset for CT numbers, found ", change.scale, " and ", change.offset);
  }
  constexpr double kMin = std::numeric_limits<std::int16_t>::min(), kMax = std::numeric_limits<std::int16_t>::max();
  for (std::int16_t& hu : ct.hu) {
    hu = static_cast<std::int16_t>(std::lround(std::clamp(hu * change.scale + change.offset, kMin, kMax)));
  }
  CtVolume made = make_ct_volume(ct.geometry, std::move(ct.hu));
  made.warnings = std::move(ct.warnings);
  made.notes = std::move(ct.notes);
  made.choices = std::move(ct.choices);
  made.hu_change = change;
  made.slice_thickness_mm = ct.slice_thickness_mm;
  return made;
}

}  // namespace

bool is_one_volume(const fs::path& path) { return detail::volume_format_of(path) != detail::VolumeFormat::kNone; }

void check_ct_file(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error) || is_one_volume(file)) return;
  switch (detail::dicom_kind_of(file)) {
    case detail::DicomKind::kSegmentation:
    case detail::DicomKind::kLabelMapSegmentation:
    case detail::DicomKind::kSurfaceSegmentation:
      fail("expected a CT, found a DICOM segmentation, which is a label map: ", file.string());
    case detail::DicomKind::kStructureSet:
      fail("expected a CT, found a DICOM structure set, which is a label map: ", file.string());
    case detail::DicomKind::kOther:
      return;
    case detail::DicomKind::kNone:
      // Perhaps without the mark of a DICOM file: its reader knows.
      if (read_dicom_headers(file).empty()) reject_foreign(file);
  }
}

CtVolume read_ct(const fs::path& path, const CtReadOptions& options, const Progress& progress) {
  CtVolume ct = read_any(path, options, progress);
  if (!options.hu.is_none()) ct = changed(std::move(ct), options.hu);
  for (std::string& warning : check_hu(ct).warnings) ct.warnings.push_back(std::move(warning));
  return ct;
}

}  // namespace spinaltap

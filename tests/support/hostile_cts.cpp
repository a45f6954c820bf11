#include "tests/support/hostile_cts.h"

#include <sys/stat.h>

#include <limits>

#include "core/base/staged_output.h"
#include "tests/support/hand_made_dicom.h"
#include "tests/support/made_nifti.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

/// Three slices, changed by `change`.
template <class Change>
HostileCt series(const std::string& name, const std::string& word, const Change& change) {
  return {name,
          [change](const fs::path& folder) {
            for (int k = 0; k < 3; ++k) {
              HandMadeDicom slice;
              slice.set_z(2.0 * k);
              std::string bytes = change(slice, k);
              write_whole_file(folder / ("slice" + std::to_string(k)), bytes);
            }
            return folder;
          },
          word};
}

HostileCt series_with(const std::string& name, const std::string& word, std::uint32_t tag, const std::string& vr,
                      const std::string& value) {
  return series(name, word, [=](HandMadeDicom& slice, int) { return slice.set(tag, vr, value).bytes(); });
}

template <class Change>
HostileCt nifti(const std::string& name, const std::string& word, const Change& change) {
  return {name,
          [change](const fs::path& folder) {
            MadeNifti made;
            made.values.assign(24, 0.0);
            change(made);
            write_whole_file(folder / "ct.nii", made.bytes());
            return folder / "ct.nii";
          },
          word};
}

std::string little_endian(std::uint32_t value) {
  std::string bytes;
  for (int n = 0; n < 4; ++n) bytes.push_back(static_cast<char>(value >> (8 * n) & 0xff));
  return bytes;
}

/// Compressed pixels in one fragment, with the syntax that says so.
std::string with_fragment(HandMadeDicom slice, const std::string& syntax, const std::string& codestream) {
  slice.remove(0x7fe00010).set_transfer_syntax(syntax);
  return slice.bytes() + std::string("\xe0\x7f\x10\x00OB\0\0\xff\xff\xff\xff\xfe\xff\x00\xe0\0\0\0\0", 20) +
         std::string("\xfe\xff\x00\xe0", 4) + little_endian(static_cast<std::uint32_t>(codestream.size())) +
         codestream + std::string("\xfe\xff\xdd\xe0\0\0\0\0", 8);
}

/// A start of JPEG 2000 that claims a size.
std::string jpeg2000_head(std::uint16_t side, std::uint32_t tile) {
  const auto u16 = [](std::uint32_t v) {
    return std::string{static_cast<char>(v >> 8 & 0xff), static_cast<char>(v & 0xff)};
  };
  const auto u32 = [&](std::uint32_t v) { return u16(v >> 16) + u16(v & 0xffff); };
  return std::string("\xff\x4f\xff\x51", 4) + u16(41) + u16(0) + u32(side) + u32(side) + u32(0) + u32(0) + u32(tile) +
         u32(tile) + u32(0) + u32(0) + u16(1) + std::string("\x0f\x01\x01", 3) + std::string(100, '\0');
}

/// 4 x 3 pixels of 16 bits whose scan stops within a code, with no marker after it.
std::string jpeg_ls_cut_short() {
  return std::string(
      "\xff\xd8"
      "\xff\xf7\x00\x0b\x10\x00\x03\x00\x04\x01\x01\x11\x00"
      "\xff\xda\x00\x08\x01\x01\x00\x00\x00\x00"
      "\x09\x97\xd1\x37\xf6\xe6\x91\x75\x2c",
      34);
}

HandMadeDicom sized(HandMadeDicom slice, int side) {
  return slice.set_short(0x00280010, side).set_short(0x00280011, side);
}

std::string raw_deflated(const std::string& bytes) {
  const std::string gzip = gzipped(bytes);
  return gzip.substr(10, gzip.size() - 18);  // without gzip's own head and tail
}

}  // namespace

std::vector<HostileCt> hostile_cts() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string rle = "1.2.840.10008.1.2.5";
  const std::string jpeg_ls = "1.2.840.10008.1.2.4.80";
  const std::string jpeg2000 = "1.2.840.10008.1.2.4.90";
  return {
      series("CutShort", "cut short",
             [](HandMadeDicom& slice, int) { return slice.bytes().substr(0, slice.bytes().size() / 2); }),
      series("LengthBeyondTheFile", "cut short",
             [](HandMadeDicom& slice, int) {
               std::string bytes = slice.set(0x00091010, "OB", "private").bytes();
               bytes.replace(bytes.find(std::string("\x09\x00\x10\x10OB", 6)) + 6, 2, "\xf0\xff");
               return bytes;
             }),
      series_with("MillionsOfRows", "at most", 0x00280010, "UL", little_endian(1000000000)),
      series("LargestRowsAndColumns", "at most", [](HandMadeDicom& slice, int) { return sized(slice, 65535).bytes(); }),
      series("PixelsThatAreNotThere", "bytes of pixels",
             [](HandMadeDicom& slice, int) { return sized(slice, 16000).bytes(); }),
      series_with("BillionsOfFrames", "frames", 0x00280008, "IS", "2000000000"),
      series_with("FramesThatAreNotThere", "expected 20000 frames", 0x00280008, "IS", "20000"),
      series_with("NoSpacing", "PixelSpacing above 0 mm", 0x00280030, "DS", "0\\0"),
      series_with("PositionsThatAreNoNumbers", "not a number", 0x00200032, "DS", "nan\\nan\\nan"),
      series_with("PositionsWithoutEnd", "not a number", 0x00200032, "DS", "0\\0\\1e999"),
      series_with("AxesThatAreNoDirections", "right angles", 0x00200037, "DS", "1\\0\\0\\1\\0\\0"),
      series("SlicesFarApart", "slices are missing",
             [](HandMadeDicom& slice, int k) {
               if (k == 2) slice.set_z(1e15);
               return slice.bytes();
             }),
      series("RunLengthsCutShort", "RLE",
             [=](HandMadeDicom& slice, int) { return with_fragment(slice, rle, std::string(80, '\1')); }),
      series("CompressedPixelsOfAbsurdSize", "bytes of pixels",
             [=](HandMadeDicom& slice, int) {
               return with_fragment(sized(slice, 16000), jpeg2000, jpeg2000_head(16000, 16000));
             }),
      series(
          "TilesWithoutNumber", "no readable header",
          [=](HandMadeDicom& slice, int) { return with_fragment(sized(slice, 700), jpeg2000, jpeg2000_head(700, 1)); }),
      series("NoCodestream", "no readable header",
             [=](HandMadeDicom& slice, int) { return with_fragment(slice, jpeg2000, "not a codestream at all"); }),
      series("JpegLsCutShortWithinACode", "cannot decode the pixels",
             [=](HandMadeDicom& slice, int) { return with_fragment(slice, jpeg_ls, jpeg_ls_cut_short()); }),
      {"SequencesWithoutEnd",
       [](const fs::path& folder) {
         std::string bytes = HandMadeDicom().remove(0x7fe00010).bytes();
         for (int n = 0; n < 100000; ++n) {
           bytes += std::string("\x00\x52\x30\x92SQ\0\0\xff\xff\xff\xff\xfe\xff\x00\xe0\xff\xff\xff\xff", 20);
         }
         write_whole_file(folder / "deep", bytes);
         return folder;
       },
       "cut short"},
      {"DeflatedToAThousandTimesItsSize",
       [](const fs::path& folder) {
         const std::string whole = HandMadeDicom().set_transfer_syntax("1.2.840.10008.1.2.1.99").bytes();
         const std::size_t data_set = whole.find(std::string("\x08\x00\x16\x00UI", 6));
         const std::string zeros = std::string("\x09\x00\x10\x10OB\0\0", 8) + little_endian(40u << 20);
         write_whole_file(folder / "bomb", whole.substr(0, data_set) + raw_deflated(whole.substr(data_set, 34) + zeros +
                                                                                    std::string(40u << 20, '\0')));
         return folder;
       },
       "cut short"},
      {"Fifo",
       [](const fs::path& folder) {
         ::mkfifo((folder / "fifo").c_str(), 0600);
         return folder / "fifo";
       },
       "something else"},
      {"FifoWithANiftiName",
       [](const fs::path& folder) {
         ::mkfifo((folder / "fifo.nii.gz").c_str(), 0600);
         return folder / "fifo.nii.gz";
       },
       "something else"},
      {"FolderOfAFifo",
       [](const fs::path& folder) {
         ::mkfifo((folder / "fifo").c_str(), 0600);
         return folder;
       },
       "found none"},
      {"LoopOfLinks",
       [](const fs::path& folder) {
         fs::create_symlink(folder / "b", folder / "a");
         fs::create_symlink(folder / "a", folder / "b");
         return folder / "a";
       },
       "expected a folder"},
      {"FolderInALoop",
       [](const fs::path& folder) {
         fs::create_directory_symlink(folder, folder / "again");
         return folder;
       },
       "found none"},
      {"Nothing", [](const fs::path& folder) { return folder / "gone"; }, "no such folder"},
      nifti("NiftiOfAbsurdSize", "at most",
            [](MadeNifti& made) { made.dim = {7, 32767, 32767, 32767, 32767, 32767, 32767, 32767}; }),
      nifti("NiftiOfOneAbsurdVolume", "at most",
            [](MadeNifti& made) { made.dim = {3, 32767, 32767, 32767, 1, 1, 1, 1}; }),
      nifti("NiftiOfNegativeSize", "at most", [](MadeNifti& made) { made.dim = {3, -4, -3, 2, 1, 1, 1, 1}; }),
      nifti("SecondNiftiOfAbsurdSize", "at most",
            [](MadeNifti& made) {
              made.is_second = true;
              made.dim = {3, 1LL << 62, 4, 4, 1, 1, 1, 1};
            }),
      nifti("NiftiWithoutSoManyAxes", "broken", [](MadeNifti& made) { made.dim[0] = 30000; }),
      nifti("NiftiThatClaimsMoreThanItHolds", "cut short",
            [](MadeNifti& made) { made.dim = {3, 500, 500, 500, 1, 1, 1, 1}; }),
      nifti("NiftiWithoutSpacing", "gives voxels a volume", [](MadeNifti& made) { made.ras_steps.setZero(); }),
      nifti("NiftiWhoseSpacingIsNoNumber", "gives voxels a volume",
            [nan](MadeNifti& made) { made.ras_steps(1, 1) = nan; }),
      nifti("NiftiWhoseVoxelsBeginNowhere", "broken", [](MadeNifti& made) { made.values_at = 3e9; }),
      nifti("NiftiWhoseScaleIsNoNumber", "scl_slope", [nan](MadeNifti& made) { made.slope = nan; }),
      nifti("NiftiOfTwoFiles", "in one", [](MadeNifti& made) { made.magic = "ni1"; }),
      nifti("NiftiSkewedTwice", "right angles", [](MadeNifti& made) { made.ras_steps(0, 1) = 0.5; }),
      {"GzippedNiftiCutShort",
       [](const fs::path& folder) {
         MadeNifti made;
         made.dim = {3, 40, 30, 20, 1, 1, 1, 1};
         for (int n = 0; n < 24000; ++n) made.values.push_back(n * 7919 % 1000);
         const std::string bytes = gzipped(made.bytes());
         write_whole_file(folder / "ct.nii.gz", bytes.substr(0, bytes.size() / 2));
         return folder / "ct.nii.gz";
       },
       "cut short"},
      {"NiftiNameOnOtherBytes",
       [](const fs::path& folder) {
         write_whole_file(folder / "ct.nii", std::string(1000, 'x'));
         return folder / "ct.nii";
       },
       "broken"},
      {"EmptyFile",
       [](const fs::path& folder) {
         write_whole_file(folder / "ct.nii.gz", "");
         return folder / "ct.nii.gz";
       },
       "broken"},
  };
}

}  // namespace spinaltap::test

// CTs as users of other programs reported them, which were read wrong without a word: what the program answers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "core/base/staged_output.h"
#include "core/ct/detail/dicom_values.h"
#include "tests/cli/program.h"
#include "tests/support/corrupted_series.h"
#include "tests/support/made_nifti.h"
#include "tests/support/made_series.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::HandMadeDicom;
using test::ProgramRun;
using test::SoundSeries;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

using Change = std::function<void(HandMadeDicom&, std::size_t)>;

class ReportedCts : public testing::Test {
 protected:
  /// What `info` says of the sound series of this number with something changed in each file.
  ProgramRun info(std::size_t number, const Change& change, const std::string& options = "") {
    SoundSeries series = test::sound_series().at(number);
    fs::remove_all(folder_.path() / "ct");
    fs::create_directory(folder_.path() / "ct");
    for (std::size_t n = 0; n < series.files.size(); ++n) {
      change(series.files[n], n);
      write_whole_file(folder_.path() / "ct" / ("slice" + std::to_string(100 + n)), series.files[n].bytes());
    }
    return test::run_program("info ct " + options, folder_.path());
  }
  ProgramRun info_of_values(const std::function<double(int)>& change) {
    const CtVolume ct = test::sound_series()[0].ground_truth;
    test::MadeNifti nifti;
    for (std::size_t axis = 0; axis < 3; ++axis) nifti.dim[axis + 1] = static_cast<short>(ct.geometry.size[axis]);
    for (const std::int16_t hu : ct.hu) nifti.values.push_back(change(hu));
    write_whole_file(folder_.path() / "ct.nii.gz", test::gzipped(nifti.bytes()));
    return test::run_program("info ct.nii.gz", folder_.path());
  }

  test::TemporaryFolder folder_;
};

void expect_warned(const ProgramRun& run, const std::string& word) {
  EXPECT_EQ(run.exit_code, 1) << run.output << run.errors;
  EXPECT_THAT(run.output, HasSubstr(word));
}
void expect_refused(const ProgramRun& run, const std::string& word) {
  EXPECT_EQ(run.exit_code, 2) << run.output << run.errors;
  EXPECT_THAT(run.errors, HasSubstr(word));
}
void expect_read(const ProgramRun& run, const std::string& word) {
  EXPECT_EQ(run.exit_code, 0) << run.output << run.errors;
  EXPECT_THAT(run.output, AllOf(HasSubstr(word), Not(HasSubstr("doubtful"))));
}

TEST_F(ReportedCts, SoundOnesAreReadWithoutAWord) {
  for (std::size_t n = 0; n < 3; ++n) expect_read(info(n, [](HandMadeDicom&, std::size_t) {}), "12 slices");
  expect_read(info_of_values([](int hu) { return static_cast<double>(hu); }), "64 x 48 x 12");
}

TEST_F(ReportedCts, WithoutRescalingAreRefused) {
  const Change none = [](HandMadeDicom& file, std::size_t) { file.remove(0x00281052).remove(0x00281053); };
  expect_refused(info(1, none), "PS3.3, C.8.2.1");
  EXPECT_EQ(info(1, none, "--hu-offset=-1024").exit_code, 0);
}

TEST_F(ReportedCts, OfElectronDensityAreRefused) {
  expect_refused(info(0, [](HandMadeDicom& file, std::size_t) { file.set(0x00281054, "LO", "ED"); }),
                 "the RescaleType ED");
}

TEST_F(ReportedCts, WithFilesWithoutPreambleAreReadWhole) {
  SoundSeries series = test::sound_series()[0];
  fs::create_directory(folder_.path() / "ct");
  for (std::size_t n = 0; n < series.files.size(); ++n) {
    // The data set alone, as implicit little endian.
    series.files[n].make_implicit();
    const std::string bytes = series.files[n].bytes();
    const std::size_t data = bytes.find(std::string("\x08\x00\x08\x00", 4));
    write_whole_file(folder_.path() / "ct" / ("slice" + std::to_string(100 + n)),
                     n % 3 == 0 ? bytes.substr(data) : bytes);
  }
  expect_read(test::run_program("info ct", folder_.path()), "12 slices");
}

TEST_F(ReportedCts, OfTwoFramesOfReferenceAreListedApart) {
  const Change two = [](HandMadeDicom& file, std::size_t n) {
    file.set(0x00200052, "UI", n < 7 ? "1.2.826.1" : "1.2.826.2");
  };
  const ProgramRun listed = info(0, two);
  EXPECT_THAT(listed.output, AllOf(HasSubstr("7 slices"), HasSubstr("5 slices"), HasSubstr("FrameOfReferenceUID")));
  expect_refused(test::run_program("segment ct --seed-point 0,0,0", folder_.path()), "--stack");
  EXPECT_THAT(test::run_program("info ct --stack 2", folder_.path()).output, HasSubstr("64 x 48 x 5"));
}

TEST_F(ReportedCts, WhoseCodestreamContradictsTheHeaderAreRefused) {
  const std::string is_signed = std::string("\x28\x00\x03\x01US\x02\x00", 8);
  const std::string bits_stored = std::string("\x28\x00\x01\x01US\x02\x00", 8);
  const std::string high_bit = std::string("\x28\x00\x02\x01US\x02\x00", 8);
  struct Lie {
    bool made_signed;
    std::vector<std::pair<std::string, char>> changes;
    const char* word;
  };
  const std::vector<Lie> lies{{true, {{is_signed, 0}}, "sign"}, {false, {{is_signed, 1}}, "sign"}};
  for (const Lie& lie : lies) {
    test::MadeSeries series = test::make_series({.name = "",
                                                 .syntax = gdcm::TransferSyntax::JPEG2000Lossless,
                                                 .bits_stored = 12,
                                                 .is_signed = lie.made_signed,
                                                 .intercept = lie.made_signed ? 0 : -1024});
    for (test::MadeSeries::File& file : series.files) {
      for (const auto& [tag, value] : lie.changes) {
        const std::size_t at = file.bytes.find(tag);
        ASSERT_NE(at, std::string::npos);
        file.bytes[at + tag.size()] = value;
      }
    }
    fs::remove_all(folder_.path() / "ct");
    fs::create_directory(folder_.path() / "ct");
    series.write(folder_.path() / "ct");
    expect_refused(test::run_program("info ct", folder_.path()), lie.word);
  }
}

TEST_F(ReportedCts, WhoseNumbersAreOffAreWarnedOf) {
  expect_warned(info_of_values([](int hu) { return hu + 1024.0; }), "+ 1024");
  expect_warned(info_of_values([](int hu) { return std::clamp(std::round((hu + 1000.0) / 8.0), 0.0, 255.0); }),
                "8 bits");
  expect_warned(info_of_values([](int hu) { return hu + 100.0; }), "looks like CT numbers + 1");
  expect_warned(info_of_values([](int hu) { return hu * 1.3; }), "CT numbers");
  expect_warned(info_of_values([](int hu) { return std::clamp(hu, -160, 240) * 1.0; }), "window");
}

TEST_F(ReportedCts, WithCopiesCountEachSliceOnce) {
  info(0, [](HandMadeDicom&, std::size_t) {});
  for (const char* name : {"slice103", "slice107"}) {
    fs::copy_file(folder_.path() / "ct" / name, folder_.path() / "ct" / (std::string(name) + "-copy"));
  }
  const ProgramRun run = test::run_program("info ct", folder_.path());
  expect_read(run, "12 slices");
  EXPECT_THAT(run.output, HasSubstr("2 of 14 slices are copies"));
}

TEST_F(ReportedCts, WhosePositionsAreRoundedToTenthsAreEven) {
  const Change rounded = [](HandMadeDicom& file, std::size_t n) {
    const double z_mm = std::round((-512.5 + 0.625 * static_cast<double>(n)) * 10.0) / 10.0;
    file.set(0x00200032, "DS", "-76.8\\-60\\" + to_decimal_string(z_mm)).set(0x00180050, "DS", "0.625");
    file.remove(0x00201041);
  };
  expect_read(info(0, rounded), "0.625");
}

}  // namespace
}  // namespace spinaltap

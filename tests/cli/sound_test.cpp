// The sound of recorded drillings, as from a shell: through a phantom's pedicle, through a ball.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/files/recorded_setup.h"
#include "core/session/record/session_record.h"
#include "tests/cli/bone_ball.h"
#include "tests/cli/program.h"
#include "tests/support/heard_drilling.h"
#include "tests/support/spectrum.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::run_program;
using testing::HasSubstr;

/// A WAV file of 16 or 24 bits, read by the letter of its format: chunks of a name, a length and so many bytes.
struct Wav {
  std::uint32_t channels = 0, rate_hz = 0, bits = 0;
  std::vector<float> samples;

  explicit Wav(const std::string& bytes) {
    const auto number = [&](std::size_t at, std::size_t size) {
      std::uint32_t value = 0;
      for (std::size_t n = size; n-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes.at(at + n));
      return value;
    };
    EXPECT_EQ(bytes.substr(0, 4) + bytes.substr(8, 4), "RIFFWAVE");
    EXPECT_EQ(number(4, 4) + 8, bytes.size());
    for (std::size_t at = 12; at + 8 <= bytes.size();) {
      const std::string name = bytes.substr(at, 4);
      const std::size_t size = number(at + 4, 4);
      if (name == "fmt ") {
        channels = number(at + 10, 2);
        rate_hz = number(at + 12, 4);
        bits = number(at + 22, 2);
      } else if (name == "data") {
        const std::size_t width = bits / 8;
        for (std::size_t n = 0; n < size / width; ++n) {
          const auto value = static_cast<std::int32_t>(number(at + 8 + n * width, width) << (32 - bits));
          samples.push_back(static_cast<float>(value * 0x1p-31));
        }
      }
      at += 8 + size + size % 2;
    }
  }
};

class Sound : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    test::write_bone_ball(in("bone.vdb"));
    const Vec3 direction = Vec3(1.0, 2.0, -2.0) / 3.0;
    write_plan({{"through", test::kBoneCentre - test::kBoneRadiusMm * direction, test::kBoneCentre + 1.0 * direction,
                 DrillBit{2.0, 30.0, 2.0}}},
               in("plan.json"));
    // What `drill` would record of a phantom, without its grids, meshes and report, which take a minute.
    test::PedicleSession pedicle(Vertebra().anatomy(), true);
    RecordWriter record(in("run.h5"), record_setup(pedicle.setup));
    pedicle.run([&](const Cycle& cycle) { record.add_waiting(cycle); });
    record.close(pedicle.session->events());
    end_mm_ = pedicle.end_mm;
  }
  static void TearDownTestSuite() { delete folder_; }
  static std::filesystem::path in(const std::string& name) { return folder_->path() / name; }
  static test::ProgramRun sound(const std::string& arguments) {
    return run_program("sound " + arguments, folder_->path());
  }

  static const test::TemporaryFolder* folder_;
  static double end_mm_;
};

const test::TemporaryFolder* Sound::folder_ = nullptr;
double Sound::end_mm_ = 0.0;

TEST_F(Sound, IsAsLongAsTheSessionAndTheSameByteForByte) {
  const SessionRecord record = read_record(in("run.h5"));
  ASSERT_EQ(sound("run.h5 -o a.wav --json a.json --threads 1").exit_code, 0);
  ASSERT_EQ(sound("run.h5 -o b.wav --threads 2").exit_code, 0);
  const std::string bytes = read_whole_file(in("a.wav"));
  EXPECT_TRUE(bytes == read_whole_file(in("b.wav")));
  const Wav wav(bytes);
  EXPECT_EQ(wav.channels, 1U);
  EXPECT_EQ(wav.rate_hz, 48000U);
  EXPECT_EQ(wav.bits, 16U);
  EXPECT_NEAR(static_cast<double>(wav.samples.size()), 48000.0 * record.cycles.back().time_s, 1.0);
  float peak = 0.0F;
  for (const float sample : wav.samples) peak = std::max(peak, std::abs(sample));
  EXPECT_NEAR(read_json(in("a.json")).at("peak").get<double>(), peak, 1.0 / 32768.0);

  ASSERT_EQ(sound("run.h5 -o c.wav --rate 44100 --bits 24 --volume 0.5").exit_code, 0);
  const Wav other(read_whole_file(in("c.wav")));
  EXPECT_EQ(other.rate_hz, 44100U);
  EXPECT_EQ(other.bits, 24U);
  EXPECT_NEAR(static_cast<double>(other.samples.size()), 44100.0 * record.cycles.back().time_s, 1.0);
}

TEST_F(Sound, HasItsPeaksAtTheSpindlesHarmonics) {
  ASSERT_EQ(sound("run.h5 -o spectrum.wav").exit_code, 0);
  const Wav wav(read_whole_file(in("spectrum.wav")));
  const std::span<const float> samples(wav.samples);
  constexpr double kTurningHz = 1250.0 / 60.0;  // the default spindle
  // From 1 s to 2 s the bit comes up to the bone through air; bins are 1 Hz wide.
  for (int k = 1; k <= 12; ++k) {
    EXPECT_NEAR(test::peak_near(samples.subspan(48000, 48000), k * kTurningHz, 48000.0, 6), k * kTurningHz, 1.0) << k;
  }
  // At 25 s it is in cancellous bone, whose torque takes a thousandth of the speed.
  for (int m = 1; m <= 8; ++m) {
    const double hz = 2.0 * m * kTurningHz;
    EXPECT_NEAR(test::peak_near(samples.subspan(25 * 48000, 48000), hz, 48000.0, 6), hz, 1.0) << m;
  }
}

TEST_F(Sound, TellsWhenTheDrillBrokeThroughAndThatItWasHeard) {
  ASSERT_EQ(sound("run.h5 -o events.wav --events events.json").exit_code, 0);
  const Json events = read_json(in("events.json"));
  double through_s = 0.0;
  for (const RecordedCycle& cycle : read_record(in("run.h5")).cycles) {
    if (cycle.depth_mm < end_mm_) through_s = cycle.time_s;
  }
  ASSERT_EQ(events.at("breakthroughs").size(), 1U);
  EXPECT_NEAR(events.at("breakthroughs")[0].at("time_s").get<double>(), through_s, 0.3);
  ASSERT_EQ(events.at("heard").size(), 1U) << events.dump();
  const double late_s = events.at("heard")[0].at("time_s").get<double>() - through_s;
  EXPECT_GT(late_s, -0.1);
  EXPECT_LT(late_s, 0.14);
}

TEST_F(Sound, IsMadeOfWhatDrillRecords) {
  const test::ProgramRun drilled = run_program(
      "drill bone.vdb plan.json --radius 1.2 --spacing 0.2 --step 0.02 --no-clearances --full-mesh --no-pictures "
      "--record ball.h5 -o out",
      folder_->path());
  ASSERT_EQ(drilled.exit_code, 0) << drilled.errors;
  const test::ProgramRun heard = sound("ball.h5 -o ball.wav");
  ASSERT_EQ(heard.exit_code, 0) << heard.errors;
  EXPECT_GT(test::rms(Wav(read_whole_file(in("ball.wav"))).samples), 0.01);
}

TEST_F(Sound, LeavesNothingBehindWhereItCannotBeMade) {
  const std::string bytes = read_whole_file(in("run.h5"));
  write_whole_file(in("half.h5"), bytes.substr(0, bytes.size() / 2));
  write_whole_file(in("mine.wav"), "mine");
  std::filesystem::create_directory(in("folder"));
  const std::vector<std::string> before = test::everything_in(folder_->path());
  const auto rejected = [&](const std::string& arguments, const std::string& why) {
    const test::ProgramRun run = sound(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_THAT(run.errors, HasSubstr(why)) << arguments;
    EXPECT_EQ(test::everything_in(folder_->path()), before) << arguments;
  };
  rejected("", "record is required");
  rejected("none.h5 -o x.wav", "none.h5");
  rejected("plan.json -o x.wav", "expected spinaltap sound RECORD: plan.json is a plan");
  rejected("half.h5 -o x.wav", "half.h5");
  rejected("run.h5 -o mine.wav", "is there already");
  rejected("run.h5 -o x.wav --events mine.wav", "is there already");
  rejected("run.h5 -o folder", "folder");
  rejected("run.h5 -o x.wav --rate 8000", "--rate");
  rejected("run.h5 -o x.wav --bits 8", "--bits");
  rejected("run.h5 -o x.wav --volume nan", "volume");
  rejected("run.h5 -o x.wav --volume -1", "--volume");
  rejected("run.h5 -o x.wav --edges 65", "--edges");
  rejected("run.h5 -o x.wav --seed x", "--seed");
  EXPECT_EQ(read_whole_file(in("mine.wav")), "mine");
  // A disk that is full, or a limit on files as here, leaves no half sound.
  const test::ProgramRun full = run_program("sound run.h5 -o x.wav", folder_->path(), "trap '' XFSZ; ulimit -f 512;");
  EXPECT_EQ(full.exit_code, 2) << full.output;
  EXPECT_THAT(full.errors, HasSubstr("x.wav"));
  EXPECT_EQ(test::everything_in(folder_->path()), before);
}

}  // namespace
}  // namespace spinaltap

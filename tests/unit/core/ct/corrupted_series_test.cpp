// Compiled with optimisation: long loops of its own.
// A thousand headers that lie: each is read right, refused or warned of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_writer.h"
#include "core/ct/read_ct.h"
#include "tests/support/corrupted_series.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"
#include "tests/support/test_paths.h"

namespace spinaltap {
namespace {

using test::Corruption;
using test::SoundSeries;
using test::TemporaryFolder;

/// What may come of a header that lies. Two kinds of lies no header can show: CT numbers off by less than scanners
/// differ, or one air taken for another; and all positions alike at another place, or counted from the other end.
enum class Outcome { right, refused, warned, slight, moved, silent };
constexpr std::size_t kOutcomes = 6;

struct Answer {
  Outcome outcome = Outcome::silent;
  std::string words;
};

/// Slices in the order of positions whose signs were all turned.
bool is_turned_over(const CtVolume& ct, const CtVolume& expected) {
  const std::size_t slice = ct.geometry.offset(0, 0, 1);
  for (int k = 0; k < ct.geometry.size[2]; ++k) {
    const auto first = ct.hu.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(k) * slice);
    const auto other = expected.hu.end() - static_cast<std::ptrdiff_t>(static_cast<std::size_t>(k + 1) * slice);
    if (!std::equal(first, first + static_cast<std::ptrdiff_t>(slice), other)) return false;
  }
  return true;
}

bool is_slight(int a, int b) {
  constexpr int kScannersDifferHu = 10, kAirHu = -900;
  return std::abs(a - b) <= kScannersDifferHu || (a < kAirHu && b < kAirHu);
}

Answer compared(const CtVolume& ct, const CtVolume& expected) {
  if (ct.geometry.size != expected.geometry.size) return {Outcome::silent, "another size"};
  double off_mm = 0.0, bent_mm = 0.0;
  for (const int corner : {0, 1}) {
    const Vec3 p_index = corner * Vec3(ct.geometry.size[0] - 1, ct.geometry.size[1] - 1, ct.geometry.size[2] - 1);
    const auto place = [&](const GridGeometry& grid) { return grid.to_patient(p_index); };
    off_mm = std::max(off_mm, (place(ct.geometry) - place(expected.geometry)).norm());
    bent_mm = std::max(
        bent_mm,
        (place(ct.geometry) - ct.geometry.origin_mm - place(expected.geometry) + expected.geometry.origin_mm).norm());
  }
  std::size_t others = 0;
  bool are_slight = true;
  for (std::size_t n = 0; n < ct.hu.size(); ++n) {
    if (ct.hu[n] == expected.hu[n]) continue;
    ++others;
    are_slight = are_slight && is_slight(ct.hu[n], expected.hu[n]);
  }
  constexpr double kMaxOffMm = 0.1;
  const std::string words = joined(others, " voxels differ, places by up to ", off_mm, " mm");
  if (off_mm < kMaxOffMm) {
    return {others == 0 ? Outcome::right : are_slight ? Outcome::slight : Outcome::silent, words};
  }
  const bool is_as_it_was = others == 0 || is_turned_over(ct, expected);
  return {bent_mm < kMaxOffMm && is_as_it_was ? Outcome::moved : Outcome::silent, words};
}

Answer answer_to(const SoundSeries& series) {
  const TemporaryFolder folder;
  for (std::size_t n = 0; n < series.files.size(); ++n) {
    write_whole_file(folder.path() / ("slice" + std::to_string(100 + n)), series.files[n].bytes());
  }
  try {
    const CtVolume ct = read_ct(folder.path());
    if (!ct.warnings.empty()) return {Outcome::warned, ct.warnings.front()};
    return compared(ct, series.ground_truth);
  } catch (const Error& error) {
    return {Outcome::refused, error.what()};
  }
}

SLOW_TESTS("CorruptedSeries.NoneOfTwoThousandIsReadWrongWithoutAWord");

TEST(CorruptedSeries, SoundOnesAreReadWithoutAWord) {
  for (const SoundSeries& series : test::sound_series()) {
    const Answer answer = answer_to(series);
    EXPECT_EQ(answer.outcome, Outcome::right) << series.name << ": " << answer.words;
  }
}

TEST(CorruptedSeries, NoneOfTwoThousandIsReadWrongWithoutAWord) {
  const std::vector<SoundSeries> sound = test::sound_series();
  std::map<std::string, std::array<int, kOutcomes>> table;
  // The first thousand was looked at while the rules were made, the second was not.
  for (const std::uint64_t first : {std::uint64_t{0}, std::uint64_t{2'000'000}}) {
    for (std::uint64_t seed = first; seed < first + 1000; ++seed) {
      SoundSeries series = sound[seed % sound.size()];
      const Corruption made = corrupt(series, seed);
      const Answer answer = answer_to(series);
      const std::string thousand = first == 0 ? "**first thousand**" : "**second thousand**";
      for (const std::string& row : {made.attribute, thousand}) ++table[row][static_cast<std::size_t>(answer.outcome)];
      EXPECT_NE(answer.outcome, Outcome::silent)
          << seed << ": " << series.name << ", " << made.attribute << " " << made.kind << " in " << made.scope << " ("
          << made.change << "): " << answer.words;
    }
  }
  std::string text = "| attribute | right | refused | warned of | slight | moved |\n|---|---|---|---|---|---|\n";
  for (const auto& [row, counts] : table) {
    text += "| " + row + " |";
    for (std::size_t n = 0; n + 1 < kOutcomes; ++n) text += " " + std::to_string(counts[n]) + " |";
    text += "\n";
  }
  EXPECT_NE(read_whole_file(std::string(test::kSourceFolder) + "/docs/checks.md").find(text), std::string::npos)
      << "the page's table is to be\n"
      << text;
}

}  // namespace
}  // namespace spinaltap

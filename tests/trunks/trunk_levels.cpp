// trunk_levels FOLDER FIRST COUNT [STEP]: examines COUNT random trunks, every STEPth (2) seed from FIRST on. Leaves in
// FOLDER levels.csv, a line for each level that lies whole in a CT, with how right it is and what doubt may be learned
// from, failures.html, pictures of those that are missed or wrong, and failures.png, the first of each CT.

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>

#include "apps/report/html_report.h"
#include "apps/report/png.h"
#include "core/base/staged_output.h"
#include "core/base/text_writer.h"
#include "tests/trunks/failure_picture.h"
#include "tests/trunks/level_table.h"

namespace spinaltap::test {
namespace {

using Gallery = std::vector<std::pair<Image, std::string>>;

void show_failures(const TrunkExam& exam, HtmlReport& page, Gallery& gallery) {
  bool is_first = true;
  for (const WholeLevelScore& level : exam.score.levels) {
    if (!exam.is_wrong(level)) continue;
    page.add_heading(exam.what() + ", " + level_name(level.level));
    std::string words = level.is_told ? "said" : "NOT A WORD";
    if (level.found) {
      const LevelReport& report = exam.report_of(level);
      words = joined("found as ", report.name, ", Dice ", fixed_text(level.dice, 3), ", severity ",
                     fixed_text(report.severity, 2), ": ", warnings_in_line(report));
    } else {
      words = "missed, " + words;
      for (const std::string& gap : exam.found.gaps) words += "; " + gap;
    }
    page.add_text(words);
    const Image picture = failure_picture(exam, level);
    page.add_pictures({{picture, "truth blue; found orange, dashed"}});
    constexpr std::size_t kMost = 8;
    if (is_first && gallery.size() < kMost) {
      const std::string outcome = level.found ? "DICE " + fixed_text(level.dice, 2) : "MISSED";
      gallery.emplace_back(picture, joined("SEED ", exam.seed, ", ", level_name(level.level), ": ", outcome,
                                           level.is_told ? ", SAID" : ", NOT SAID"));
    }
    is_first = false;
  }
}

int run(const std::filesystem::path& folder, std::uint64_t first, std::uint64_t count, std::uint64_t step) {
  std::filesystem::create_directories(folder);
  LevelTable table(folder / "levels.csv");
  Gallery gallery;
  HtmlReport page("Levels of random trunks that are missed or wrong");
  for (std::uint64_t n = 0; n < count; ++n) {
    const TrunkExam exam = examine_trunk(first + n * step);
    int wrong = 0;
    for (const WholeLevelScore& level : exam.score.levels) {
      table.add({std::to_string(exam.seed), exam.options.scan.slice_step_mm, level_name(level.level),
                 level.found ? &exam.report_of(level) : nullptr, level.dice, level.centre_mm, exam.is_wrong(level),
                 level.is_told, level.found ? doubt_figures(exam.ct, exam.found, *level.found) : DoubtFigures{}});
      wrong += exam.is_wrong(level) ? 1 : 0;
    }
    std::printf("%s: %zu whole levels, %d wrong or missed\n", exam.what().c_str(), exam.score.levels.size(), wrong);
    std::fflush(stdout);
    show_failures(exam, page, gallery);
  }
  StagedOutput output;
  output.write(folder / "failures.html", page.html());
  if (!gallery.empty()) output.write(folder / "failures.png", encode_png(captioned(gallery)));
  output.commit();
  return 0;
}

}  // namespace
}  // namespace spinaltap::test

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: trunk_levels FOLDER FIRST COUNT [STEP]\n");
    return 2;
  }
  const auto number = [&](int n, std::uint64_t otherwise) {
    return n < argc ? std::strtoull(argv[n], nullptr, 10) : otherwise;
  };
  try {
    return spinaltap::test::run(argv[1], number(2, 0), number(3, 1), number(4, 2));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "trunk_levels: %s\n", error.what());
    return 1;
  }
}

#include <gmock/gmock.h>

#include <QDoubleSpinBox>
#include <QImage>
#include <QProcess>
#include <QProcessEnvironment>
#include <fstream>
#include <sstream>

#include "apps/report/bit_outline.h"
#include "apps/spinaltap-planner/script/planner_script.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/plan_file.h"
#include "core/session/record/session_record.h"
#include "tests/gui/planner_window.h"
#include "tests/support/german_locale.h"

namespace spinaltap::test {
namespace {

std::vector<ScriptLine> script(const std::string& text) {
  std::istringstream lines(text);
  return read_script(lines, "test.txt");
}

TEST(ReadScript, SplitsWordsAndLeavesCommentsOut) {
  const std::vector<ScriptLine> lines =
      script("# a comment\n\nopen \"my bone.vdb\"  # another\r\nscrew \"6.5 x 45 mm\"\n");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].number, 3);
  EXPECT_EQ(lines[0].command, "open");
  EXPECT_THAT(lines[0].words, testing::ElementsAre("my bone.vdb"));
  EXPECT_THAT(lines[1].words, testing::ElementsAre("6.5 x 45 mm"));
}

TEST(ReadScript, NamesTheLineWithoutAClosingQuote) {
  EXPECT_THAT([] { script("undo\nopen \"bone\n"); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("test.txt, line 2")));
}

using PlannerScript = PlannerWindow;

TEST_F(PlannerScript, OpensPlansDrillsAndSaves) {
  const std::string here = folder.path().string() + "/";
  const DrillPath path = phantom_paths().front();
  std::ostringstream text;
  text.precision(17);
  text << "open \"" << phantom_file().string() << "\"\n"
       << "add mine " << path.entry_mm.transpose() << " " << path.target_mm.transpose() << "\n"
       << "bit \"Drill 2.5 mm\"\nscrew \"5 x 40 mm\"\nscrew none\n"
       << "target " << (path.target_mm + Vec3(0.0, 0.0, 1.0)).transpose() << "\nundo\n"
       << "view hole\nopacity 0.5\nguide axial on\ntools off\ntools on\nwindow 2000 400\npage path\npane 3d\npane all\n"
       << "drill feed=5 speed=0\nwait\n"
       << "record " << here << "run.h5\nundo-hole\n"
       << "save " << here << "plan.json\nsave " << here << "plan.mrk.json\nreport " << here << "plan.html\nsave-bone "
       << here << "bone.vdb\n"
       << "picture " << here << "window.png\npicture " << here << "3d.png 3d\npicture " << here << "path.png path\n";
  run_script(*window, script(text.str()), "test.txt");
  const std::vector<DrillPath> saved = read_plan(folder.path() / "plan.json");
  ASSERT_EQ(saved.size(), 1U);
  EXPECT_EQ(saved[0].name, "mine");
  EXPECT_EQ(saved[0].entry_mm, path.entry_mm);
  EXPECT_EQ(saved[0].target_mm, path.target_mm);
  EXPECT_EQ(saved[0].bit.diameter_mm, 2.5);
  EXPECT_FALSE(saved[0].screw);
  const SessionRecord record = read_record(folder.path() / "run.h5");
  EXPECT_TRUE(record.is_whole);
  EXPECT_NEAR(record.cycles.back().depth_mm, path.length_mm(), 0.01);
  const QImage picture(text_of(here + "window.png"));
  EXPECT_EQ(picture.size(), window->size() * window->devicePixelRatioF());
  for (const char* name : {"3d.png", "path.png", "plan.html", "plan.mrk.json", "bone.vdb"}) {
    EXPECT_GT(std::filesystem::file_size(folder.path() / name), 200U) << name;
  }
}

TEST_F(PlannerScript, OpensAPlanWithASawShowsItAndCutsItsKerf) {
  const std::string here = folder.path().string() + "/";
  DrillPath path = phantom_paths().front();
  path.bit = plate_bit(8.0, 1.2, 60.0, 3.0);
  write_plan({path}, folder.path() / "saw.json");
  std::ostringstream text;
  text << "open \"" << phantom_file().string() << "\"\nopen " << here << "saw.json\ntools on\npage path\npane all\n"
       << "picture " << here << "before.png\ndrill feed=5 speed=0\nwait\npicture " << here << "after.png\n"
       << "picture " << here << "3d.png 3d\npicture " << here << "axial.png axial\nrecord " << here << "run.h5\n";
  run_script(*window, script(text.str()), "test.txt");
  ASSERT_EQ(document().paths().size(), 1U);
  EXPECT_EQ(document().paths()[0].bit, path.bit);
  EXPECT_EQ(child<QDoubleSpinBox>("bitDiameter").value(), 8.0);
  EXPECT_EQ(child<QDoubleSpinBox>("bitLength").value(), 60.0);
  EXPECT_EQ(child<QLabel>("bitThickness").text(), "and 1.20 mm thick");
  EXPECT_FALSE(child<QLabel>("bitThickness").isHidden());
  // To the target, and the mesh has the kerf: width x thickness x some of the path's length.
  EXPECT_NEAR(planner().player().last()->depth_mm, path.length_mm(), 0.01);
  EXPECT_GT(planner().player().removed(), 10'000U);
  const Vec3 middle_mm = 0.5 * (path.entry_mm + path.target_mm);
  const auto saw = planner().player().bit();
  ASSERT_TRUE(saw);
  EXPECT_LT((saw->second.tip_mm - path.target_mm).norm(), 0.02);
  EXPECT_NEAR(std::abs(saw->second.side.dot(path.direction())), 0.0, 1e-6);
  // Slices show it too.
  EXPECT_FALSE(bit_section(plane_frame(Plane::kAxial, middle_mm,
                                       Box3(middle_mm - Vec3::Constant(30.0), middle_mm + Vec3::Constant(30.0)), 0.2),
                           saw->first, saw->second)
                   .empty());
  document().set_paths(phantom_paths());
  EXPECT_TRUE(child<QLabel>("bitThickness").isHidden());
}

TEST_F(PlannerScript, NamesTheLineThatCannotBeDone) {
  show_phantom();
  EXPECT_THAT([&] { run_script(*window, script("undo\nfly away\n"), "test.txt"); },
              testing::ThrowsMessage<Error>(testing::AllOf(testing::HasSubstr("line 2"), testing::HasSubstr("fly"))));
  EXPECT_THAT([&] { run_script(*window, script("target 1 2\n"), "test.txt"); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("target X Y Z")));
  EXPECT_THAT([&] { run_script(*window, script("choose nobody\n"), "test.txt"); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("nobody")));
  for (const char* senseless :
       {"size 1e12 900", "size nan 900", "pause -1", "pause 1e300", "opacity nan", "opacity 2"}) {
    EXPECT_THAT([&] { run_script(*window, script(senseless), "test.txt"); },
                testing::ThrowsMessage<Error>(testing::HasSubstr("expected a number")))
        << senseless;
  }
  EXPECT_THAT([&] { run_script(*window, script("open nothing.vdb\n"), "test.txt"); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("nothing.vdb")));
}

/// The program itself, as from a shell.
QProcess& run_program(QProcess& process, const QStringList& arguments,
                      QProcessEnvironment environment = QProcessEnvironment::systemEnvironment()) {
  const TemporaryFolder runtime;  // Qt says a word where there is none
  environment.insert("XDG_RUNTIME_DIR", text_of(runtime.path().string()));
  process.setProcessEnvironment(environment);
  process.start(SPINALTAP_PLANNER_PROGRAM, arguments);
  process.waitForFinished(60000);
  return process;
}

TEST(PlannerProgram, SavesAScreenshotAndEnds) {
  const TemporaryFolder folder;
  const std::filesystem::path plan = folder.path() / "plan.json", picture = folder.path() / "window.png";
  write_plan(phantom_paths(), plan);
  QProcess process;
  run_program(process,
              {text_of(phantom_file().string()), text_of(plan.string()), "--screenshot", text_of(picture.string())});
  EXPECT_EQ(process.exitCode(), 0) << process.readAllStandardError().toStdString();
  EXPECT_FALSE(QImage(text_of(picture.string())).isNull());
}

TEST(PlannerProgram, ShowsTheSameNumbersUnderAGermanLocale) {
  const GermanLocale german;
  SPINALTAP_NEED_GERMAN(german);
  const TemporaryFolder folder;
  const std::filesystem::path plan = folder.path() / "plan.json";
  write_plan(phantom_paths(), plan);
  const std::filesystem::path script = folder.path() / "script.txt";
  write_whole_file(script, "save " + (folder.path() / "saved.json").string() + "\n");
  const auto in = [&](const char* locale) {
    QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
    environment.insert("LC_ALL", locale);
    environment.insert("LOCPATH", text_of(german.path()));
    const std::filesystem::path picture = folder.path() / "window.png";
    QProcess process;
    run_program(process,
                {text_of(phantom_file().string()), text_of(plan.string()), "--script", text_of(script.string()),
                 "--screenshot", text_of(picture.string())},
                environment);
    EXPECT_EQ(process.exitCode(), 0) << process.readAllStandardError().toStdString();
    std::vector<std::string> files{read_whole_file(picture), read_whole_file(folder.path() / "saved.json")};
    std::filesystem::remove(picture);
    std::filesystem::remove(folder.path() / "saved.json");
    return files;
  };
  // Panes and boxes show positions, lengths and angles.
  const std::vector<std::string> plain = in("C.UTF-8");
  EXPECT_EQ(in(GermanLocale::kName), plain);
}

TEST(PlannerProgram, SaysInALineWhatIsWrong) {
  QProcess process;
  run_program(process, {"nothing.vdb", "--screenshot", "window.png"});
  EXPECT_EQ(process.exitCode(), 2);
  const std::string said = process.readAllStandardError().toStdString();
  EXPECT_THAT(said, testing::AllOf(testing::StartsWith("spinaltap-planner: "), testing::HasSubstr("nothing.vdb")));
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1);
  QProcess help;
  run_program(help, {"--help"});
  EXPECT_EQ(help.exitCode(), 0);
  EXPECT_THAT(help.readAllStandardOutput().toStdString(), testing::HasSubstr("drill [operator=NAME|MILLING.json]"));
}

}  // namespace
}  // namespace spinaltap::test

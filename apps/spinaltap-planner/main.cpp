#include <CLI/CLI.hpp>

#include <QApplication>
#include <QLocale>
#include <QTimer>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <optional>
#include <vector>

#include "apps/spinaltap-planner/script/planner_script.h"
#include "apps/spinaltap-planner/window/main_window.h"
#include "core/base/error.h"
#include "core/base/process_changes.h"
#include "core/base/version.h"
#include "core/ct/level.h"

namespace spinaltap {
namespace {

struct PlannerOptions {
  std::vector<std::string> files;
  std::string level, script, screenshot;
};

/// What was asked for on the command line, as the lines of a script.
std::vector<ScriptLine> lines_of(const PlannerOptions& options) {
  std::vector<ScriptLine> lines;
  for (const std::string& file : options.files) {
    std::vector<std::string> words{file};
    if (!options.level.empty()) words.push_back(options.level);
    lines.push_back({0, "open", words});
  }
  if (!options.screenshot.empty()) {
    lines.push_back({0, "picture", {options.screenshot}});
  }
  return lines;
}

/// With a script or a screenshot: does that and ends. Else the window is the person's.
int run_window(const PlannerOptions& options) {
  const std::optional<Level> level = options.level.empty() ? Level::kNone : level_from_name(options.level);
  if (!level) fail("expected a vertebra such as L3, found \"", options.level, "\"");
  MainWindow window;
  window.show();
  if (options.script.empty() && options.screenshot.empty()) {
    // Boxes want a running event loop.
    QTimer::singleShot(0, &window, [&] {
      if (window.offer_lost_work()) return;
      for (const std::string& file : options.files) {
        window.open(file, {.level = *level});
        while (window.planner().job().is_running()) QApplication::processEvents(QEventLoop::WaitForMoreEvents);
      }
    });
    return QApplication::exec();
  }
  window.settle();
  PlannerOptions before = options;
  before.screenshot.clear();
  run_script(window, lines_of(before), "the command line");
  if (!options.script.empty()) {
    std::ifstream file(options.script);
    if (!file) fail("expected a script, found no ", options.script);
    run_script(window, read_script(file, options.script), options.script);
  }
  PlannerOptions after;
  after.screenshot = options.screenshot;
  run_script(window, lines_of(after), "the command line");
  return 0;
}

int run_planner(int argc, char** argv) {
  PlannerOptions options;
  CLI::App program(
      "SpinalTap planner: plan paths through a vertebra, look at them from all sides, drill them.\n"
      "Research and training software, not a medical device.");
  program.name("spinaltap-planner");
  program.set_version_flag("--version", std::string("spinaltap-planner ") + version());
  program.add_option("files", options.files, "A CT (folder or file) or a bone.vdb, and a plan for it")
      ->type_name("FILE");
  program.add_option("--level", options.level, "Which vertebra of a spine.vdb, such as L3")->type_name("LEVEL");
  program.add_option("--script", options.script, "Do what this file says, then end")->type_name("FILE");
  program.add_option("--screenshot", options.screenshot, "Open the files, run the script, save the window as PNG, end")
      ->type_name("FILE.png");
  program.footer("Lines of a script (positions in patient LPS, mm; # begins a comment):\n" + script_help() +
                 "Example: spinaltap-planner bone.vdb plan.json\n"
                 "Without a screen: xvfb-run -a -s \"-screen 0 1400x900x24\" spinaltap-planner bone.vdb "
                 "--screenshot window.png");
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);
    std::fprintf(stderr, "spinaltap-planner: %s (try --help)\n", error.what());
    return 2;
  }
  if (const char* display = std::getenv("DISPLAY"); display == nullptr || *display == '\0') {
    fail("expected a screen for the window, found none: DISPLAY is not set; without one: xvfb-run -a ",
         "-s \"-screen 0 1400x900x24\" spinaltap-planner ...");
  }
#if QT_VERSION < QT_VERSION_CHECK(6, 0, 0)  // 6 does so by itself
  QApplication::setAttribute(Qt::AA_EnableHighDpiScaling);
  QApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
#endif
  const QApplication application(argc, argv);
  // Qt has taken the user's locale for all of the process: numbers are read and written the same way under any.
  std::setlocale(LC_NUMERIC, "C");
  QLocale::setDefault(QLocale::c());
  QApplication::setOrganizationName("SpinalTap");
  QApplication::setApplicationName("spinaltap-planner");
  return run_window(options);
}

}  // namespace
}  // namespace spinaltap

int main(int argc, char** argv) {
  spinaltap::allow_process_changes({.silences_decoders = true, .silences_hdf5_at_exit = true});
  try {
    return spinaltap::run_planner(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "spinaltap-planner: not enough memory\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "spinaltap-planner: %s\n", error.what());
  }
  return 2;
}

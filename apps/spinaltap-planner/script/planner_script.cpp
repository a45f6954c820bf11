#include "apps/spinaltap-planner/script/planner_script.h"

#include <QEventLoop>
#include <QTimer>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "apps/spinaltap-planner/navigation/navigation_panel.h"
#include "apps/spinaltap-planner/scene/scene_view.h"
#include "apps/spinaltap-planner/window/four_panes.h"
#include "apps/spinaltap-planner/window/main_window.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"
#include "core/files/bit_file.h"
#include "core/files/data_files.h"
#include "core/files/milling_file.h"
#include "core/files/screw_file.h"

namespace spinaltap {
namespace {

using Words = std::vector<std::string>;

double number_of(const std::string& word) {
  const std::optional<double> value = parse_number(word);
  if (!value || !std::isfinite(*value)) fail("expected a number, found \"", word, "\"");
  return *value;
}

double number_within(const std::string& word, double min, double max) {
  const double value = number_of(word);
  if (value < min || value > max) fail("expected a number from ", min, " to ", max, ", found ", word);
  return value;
}

bool is_on(const std::string& word) {
  if (word != "on" && word != "off") fail("expected on or off, found \"", word, "\"");
  return word == "on";
}

Vec3 place_of_words(const Words& words) {
  return {number_of(words.at(0)), number_of(words.at(1)), number_of(words.at(2))};
}

/// What a script may say, and does then. Long work is waited for; what it says in boxes is an error here.
class ScriptRun {
 public:
  /// `window` may be null where no command is run.
  explicit ScriptRun(MainWindow* window) : window_(window) {}

  struct Command {
    std::size_t fewest = 0, max = 0;  ///< words
    const char* help = "";
    std::function<void(const Words&)> run;
  };
  const std::map<std::string, Command>& commands() const { return commands_; }

  void run(const ScriptLine& line) {
    const auto found = commands_.find(line.command);
    if (found == commands_.end()) fail("expected a command of the planner, found \"", line.command, "\"");
    const Command& command = found->second;
    if (line.words.size() < command.fewest || line.words.size() > command.max) {
      fail("expected \"", command.help, "\"");
    }
    command.run(line.words);
    window_->settle();
  }

 private:
  Planner& planner() { return window_->planner(); }
  PlanDocument& document() { return planner().document(); }

  const DrillPath& chosen() {
    const DrillPath* path = document().chosen_path();
    if (path == nullptr) fail("expected a chosen path, found none");
    return *path;
  }
  void change(const std::function<void(DrillPath&)>& how) {
    DrillPath path = chosen();
    how(path);
    document().change_path(document().chosen(), path, QStringLiteral("script"));
  }
  void move(PathEnd end, const Words& words) {
    chosen();
    if (!document().move_end(document().chosen(), end, place_of_words(words))) fail("that would be no path");
  }
  void choose(const std::string& name) {
    const std::vector<DrillPath>& paths = document().paths();
    const auto found = std::find_if(paths.begin(), paths.end(), [&](const DrillPath& p) { return p.name == name; });
    if (found == paths.end()) fail("expected a path of the plan, found no \"", name, "\"");
    document().choose(static_cast<int>(found - paths.begin()));
  }

  /// Until `is_done`; what the program would show in a box ends it.
  void wait_for(const std::function<bool()>& is_done) {
    QString trouble;
    QEventLoop loop;
    QObject::connect(&planner(), &Planner::trouble, &loop, [&](const QString&, const QString& why) { trouble = why; });
    QObject::connect(&planner().player(), &DrillPlayer::failed, &loop, [&](const QString& why) { trouble = why; });
    QTimer look;
    QObject::connect(&look, &QTimer::timeout, &loop, [&] {
      if (is_done() || !trouble.isEmpty()) loop.quit();
    });
    look.start(5);
    if (!is_done()) loop.exec();
    if (!trouble.isEmpty()) fail(trouble.toStdString());
  }
  void wait_for_work() {
    wait_for([this] { return !planner().is_working(); });
  }
  /// Of a CT a vertebra is baked: the one that is named or the largest that is whole. "none": it is let alone.
  void open(const std::string& file, const std::string& name) {
    const bool is_left = name == "none";
    const std::optional<Level> level = name.empty() || is_left ? Level::kNone : level_from_name(name);
    if (!level) fail("expected a vertebra such as L3, or none, found \"", name, "\"");
    planner().open(file, {.level = *level, .bakes_only_whole = !is_left});
    wait_for_work();
    if (is_left || document().bone() || planner().levels().largest() < 0) return;
    planner().show_level(planner().levels().largest());
    wait_for_work();
  }
  void bake(const std::string& what) {
    if (what.empty()) {
      planner().show_level(planner().level_here());
    } else if (what == "all") {
      planner().bake_all();
    } else {
      const std::optional<Level> level = level_from_name(what);
      const int index = level ? planner().levels().named(*level) : -1;
      if (index < 0) fail("expected a vertebra that was found in the CT, or all, found \"", what, "\"");
      planner().show_level(index);
    }
    wait_for_work();
  }
  void wait_for_drilling() {
    wait_for([this] {
      const DrillPlayer::State state = planner().player().state();
      return state == DrillPlayer::State::idle || state == DrillPlayer::State::stopped;
    });
  }

  void drill(const Words& words) {
    DrillPlan plan;
    for (const std::string& word : words) {
      const std::size_t equals = word.find('=');
      const std::string name = word.substr(0, equals);
      const std::string value = equals == std::string::npos ? "" : word.substr(equals + 1);
      if (name == "operator") {
        plan.tool_operator = value;
      } else if (name == "feed") {
        plan.feed_mm_s = number_of(value);
      } else if (name == "push") {
        plan.push_n = number_of(value);
      } else if (name == "speed") {
        plan.speed = number_of(value);
      } else if (name == "engine") {
        const auto found = engine_kinds().find(value);
        if (found == engine_kinds().end()) fail("expected an engine, found \"", value, "\"");
        plan.engine = found->second;
      } else {
        fail("expected operator=, feed=, push=, speed= or engine=, found \"", word, "\"");
      }
    }
    if (plan.tool_operator.ends_with(".json")) {
      plan.milling = std::make_shared<const Milling>(read_milling(plan.tool_operator));
      plan.tool_operator = "milling";
    }
    planner().player().start(plan);
  }
  void take_bit(const std::string& name) {
    for (const NamedBit& bit : shipped_bits()) {
      if (bit.name == name) return change([&](DrillPath& path) { path.bit = bit.bit; });
    }
    fail("expected a bit that ships, found no \"", name, "\"");
  }
  void take_screw(const std::string& name) {
    if (name == "none") return change([](DrillPath& path) { path.screw.reset(); });
    for (const PedicleScrew& screw : read_screws(data_file("screws/pedicle.json"))) {
      if (screw.name == name) return change([&](DrillPath& path) { path.screw = screw; });
    }
    fail("expected a screw of screws/pedicle.json, found no \"", name, "\"");
  }
  void show_guide(const Words& words) {
    const std::map<std::string, Plane> planes{
        {"axial", Plane::kAxial}, {"coronal", Plane::kCoronal}, {"sagittal", Plane::kSagittal}};
    const auto plane = planes.find(words[0]);
    if (plane == planes.end()) fail("expected \"guide axial|coronal|sagittal on|off\"");
    planner().view().show_guide(plane->second, is_on(words[1]));
  }

  MainWindow* window_;
  std::map<std::string, Command> commands_{
      {"open",
       {1, 2,
        "open FILE [LEVEL|none]: a CT, a bone (which of several: L3), or a plan for it; of a CT the largest whole "
        "vertebra is baked, or the one that is named, or none",
        [this](const Words& w) { open(w[0], w.size() > 1 ? w[1] : ""); }}},
      {"bake",
       {0, 1, "bake [LEVEL|all]: the vertebra of the open CT that the crosshair is in, or this one, or all",
        [this](const Words& w) { bake(w.empty() ? "" : w[0]); }}},
      {"suggest",
       {0, 0, "suggest: paths through both pedicles",
        [this](const Words&) {
          planner().suggest();
          wait_for_work();
        }}},
      {"add",
       {7, 7, "add NAME X Y Z X Y Z: a path from entry to target, LPS, mm",
        [this](const Words& w) {
          DrillPath path;
          path.name = w[0];
          path.entry_mm = place_of_words({w[1], w[2], w[3]});
          path.target_mm = place_of_words({w[4], w[5], w[6]});
          document().add_path(path);
        }}},
      {"choose", {1, 1, "choose NAME", [this](const Words& w) { choose(w[0]); }}},
      {"remove",
       {0, 0, "remove: the chosen path", [this](const Words&) { document().remove_path(document().chosen()); }}},
      {"entry",
       {3, 3, "entry X Y Z: goes to the nearest place of the surface",
        [this](const Words& w) { move(PathEnd::entry, w); }}},
      {"target", {3, 3, "target X Y Z", [this](const Words& w) { move(PathEnd::target, w); }}},
      {"bit", {1, 1, "bit NAME: of the shipped bits/pedicle.json", [this](const Words& w) { take_bit(w[0]); }}},
      {"screw",
       {1, 1, "screw NAME|none: of the shipped screws/pedicle.json, as \"6.5 x 45 mm\"",
        [this](const Words& w) { take_screw(w[0]); }}},
      {"undo", {0, 0, "undo", [this](const Words&) { document().undo_stack().undo(); }}},
      {"redo", {0, 0, "redo", [this](const Words&) { document().undo_stack().redo(); }}},
      {"crosshair",
       {3, 3, "crosshair X Y Z", [this](const Words& w) { planner().view().set_crosshair(place_of_words(w)); }}},
      {"window",
       {2, 2, "window WIDTH LEVEL: HU",
        [this](const Words& w) {
          planner().view().set_window({number_of(w[0]), number_of(w[1])});
        }}},
      {"levels",
       {1, 1, "levels on|off: outlines on the slices of a CT",
        [this](const Words& w) { planner().view().show_levels(is_on(w[0])); }}},
      {"opacity",
       {1, 1, "opacity 0..1: of the bone in 3D",
        [this](const Words& w) { planner().view().set_bone_opacity(number_within(w[0], 0.0, 1.0)); }}},
      {"guide",
       {2, 2, "guide axial|coronal|sagittal on|off: the slice in 3D", [this](const Words& w) { show_guide(w); }}},
      {"tools",
       {1, 1, "tools on|off: bits and screws in 3D; they fill the holes",
        [this](const Words& w) { planner().view().show_tools(is_on(w[0])); }}},
      {"view",
       {1, 1, "view behind|front|left|right|above|below|hole",
        [this](const Words& w) { window_->panes().scene().look_from(text_of(w[0])); }}},
      {"pane",
       {1, 1, "pane axial|coronal|sagittal|3d|all",
        [this](const Words& w) {
          if (w[0] != "all" && window_->panes().pane(text_of(w[0])) == nullptr) {
            fail("expected the pane axial, coronal, sagittal, 3d or all, found \"", w[0], "\"");
          }
          window_->panes().show_only(w[0] == "all" ? QString() : text_of(w[0]));
        }}},
      {"page",
       {1, 1, "page ct|plan|path|drill|navigate", [this](const Words& w) { window_->show_page(text_of(w[0])); }}},
      {"size",
       {2, 2, "size WIDTH HEIGHT: of the window, pixels",
        [this](const Words& w) {
          constexpr double kMax = 10000.0;
          window_->resize(static_cast<int>(number_within(w[0], 1.0, kMax)),
                          static_cast<int>(number_within(w[1], 1.0, kMax)));
        }}},
      {"drill",
       {0, 5,
        "drill [operator=NAME|MILLING.json] [feed=MM_S] [push=N] [speed=X] [engine=NAME]: the chosen path; goes on "
        "beside the script",
        [this](const Words& w) { drill(w); }}},
      {"navigate",
       {1, 2,
        "navigate hand|device|listen|connect|record [WHERE]: along the chosen path; WHERE: FILE.so[:SETTINGS] or "
        "loopback, a port, HOST:PORT, FILE.h5; goes on beside the script",
        [this](const Words& w) {
          window_->navigation().start(text_of(w[0]), w.size() > 1 ? text_of(w[1]) : QString());
        }}},
      {"pause",
       {1, 1, "pause SECONDS: lets time go by",
        [](const Words& w) {
          constexpr double kDayS = 86400.0;
          QEventLoop loop;
          QTimer::singleShot(static_cast<int>(1000.0 * number_within(w[0], 0.0, kDayS)), &loop, &QEventLoop::quit);
          loop.exec();
        }}},
      {"wait", {0, 0, "wait: until the drilling has ended", [this](const Words&) { wait_for_drilling(); }}},
      {"stop",
       {0, 0, "stop: the drilling",
        [this](const Words&) {
          planner().player().stop();
          wait_for_drilling();
        }}},
      {"back",
       {1, 1, "back SECONDS: bone and bit as they were then",
        [this](const Words& w) {
          planner().player().step_back(number_of(w[0]));
          wait_for_drilling();
        }}},
      {"go-on", {0, 0, "go-on: drills on", [this](const Words&) { planner().player().go_on(); }}},
      {"undo-hole",
       {0, 0, "undo-hole: the bone without the last hole", [this](const Words&) { planner().player().undo_hole(); }}},
      {"redo-hole", {0, 0, "redo-hole", [this](const Words&) { planner().player().redo_hole(); }}},
      {"save",
       {1, 1, "save FILE: the plan; .mrk.json for 3D Slicer", [this](const Words& w) { planner().save_plan(w[0]); }}},
      {"save-bone",
       {1, 1, "save-bone FILE.vdb",
        [this](const Words& w) {
          planner().save_bone(w[0]);
          wait_for_work();
        }}},
      {"report",
       {1, 1, "report FILE.html: on the paths",
        [this](const Words& w) {
          planner().save_report(w[0]);
          wait_for_work();
        }}},
      {"record",
       {1, 1, "record FILE.h5: of the drilling",
        [this](const Words& w) {
          planner().save_record(w[0]);
          wait_for_work();
        }}},
      {"drill-report",
       {1, 1, "drill-report FOLDER: on the drilling, as the program spinaltap writes it",
        [this](const Words& w) {
          planner().write_drill_report(w[0]);
          wait_for_work();
        }}},
      {"picture",
       {1, 2, "picture FILE.png [PANE]: of the window or axial, coronal, sagittal, 3d, path",
        [this](const Words& w) { window_->save_picture(w[0], w.size() > 1 ? text_of(w[1]) : QString()); }}},
  };
};

}  // namespace

std::string script_help() {
  TextWriter help;
  const ScriptRun none(nullptr);
  for (const auto& [name, command] : none.commands()) help << "  " << command.help << "\n";
  return help.str();
}

void run_script(MainWindow& window, const std::vector<ScriptLine>& lines, const std::string& file) {
  // What goes wrong ends the script: no box waits for a person.
  window.run_alone();
  ScriptRun run(&window);
  for (const ScriptLine& line : lines) {
    try {
      run.run(line);
    } catch (const std::exception& error) {
      if (line.number == 0) throw;  // of the command line: it has no lines
      fail(file, ", line ", line.number, ": ", error.what());
    }
  }
}

}  // namespace spinaltap

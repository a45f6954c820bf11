// The program is killed, and started again.
#include <gmock/gmock.h>

#include <signal.h>

#include <QProcess>
#include <QProcessEnvironment>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/spinaltap-planner/autosave.h"
#include "apps/spinaltap-planner/planner.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/session/record/session_record.h"
#include "tests/gui/phantom_bone.h"
#include "tests/gui/x_input.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

/// The program with a home of its own, and a keyboard.
class PlannerCrash : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder.path() / "Doe, Jane");
    bone = folder.path() / "Doe, Jane" / "secret.vdb";
    fs::copy_file(phantom_file(), bone);
    plan = folder.path() / "plan.json";
    write_plan(phantom_paths(), plan);
  }

  void start(QProcess& program, const QStringList& files) const {
    QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
    for (const char* name : {"XDG_STATE_HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_RUNTIME_DIR"}) {
      fs::create_directory(folder.path() / name);
      fs::permissions(folder.path() / name, fs::perms::owner_all);
      environment.insert(name, text_of((folder.path() / name).string()));
    }
    program.setProcessEnvironment(environment);
    program.setProcessChannelMode(QProcess::ForwardedErrorChannel);
    program.start(SPINALTAP_PLANNER_PROGRAM, files);
    ASSERT_TRUE(program.waitForStarted());
  }
  /// Waits for a window and gives it the keyboard.
  bool window(const QString& title) {
    return wait_until([&] { return !input.give_keyboard(title).isEmpty(); }, 60000);
  }
  std::vector<fs::path> kept() const {
    std::vector<fs::path> files;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder.path() / "XDG_STATE_HOME/spinaltap-planner", none)) {
      files.push_back(entry.path());
    }
    return files;
  }
  /// What is kept for after a crash; null where nothing is.
  Json kept_work() const {
    for (const fs::path& file : kept()) {
      if (file.extension() == ".json") return read_json(file);
    }
    return nullptr;
  }
  void name_file(const fs::path& file, const QString& dialog) {
    ASSERT_TRUE(window(dialog));
    input.key("ctrl+a");
    input.type(text_of(file.string()));
    input.key("Return");
    ASSERT_TRUE(wait_until([&] { return fs::exists(file); }, 180000))
        << file << " is not there; windows: " << input.titles().join(", ").toStdString();
  }

  TemporaryFolder folder;
  XInput input;
  fs::path bone, plan;
};

TEST_F(PlannerCrash, BringsBackPathsAndHolesOfAKilledProgram) {
  std::size_t cycles = 0;
  {
    QProcess program;
    start(program, {text_of(bone.string()), text_of(plan.string())});
    ASSERT_TRUE(window("plan.json - SpinalTap planner"));
    input.key("Delete");
    ASSERT_TRUE(window("plan.json* - SpinalTap planner"));
    ASSERT_TRUE(wait_until([&] { return !kept_work().is_null(); }));
    EXPECT_EQ(kept_work()["paths"].size(), 1U);
    input.key("F6");
    // Kept while it drills.
    ASSERT_TRUE(wait_until([&] { return kept_work()["session"]["holes"].size() == 1; }, 60000));
    input.key("F7");
    // And when it stands still: then it no longer grows.
    ASSERT_TRUE(wait_until(
        [&] {
          const std::size_t before = cycles;
          cycles = kept_work()["session"]["holes"][0]["cycles"].get<std::size_t>();
          let_work(700);
          return cycles > 0 && cycles == before;
        },
        60000));
    const std::string text = kept_work().dump();
    for (const char* name : {"Doe", "Jane", "secret", "vdb", "plan.json", "spinaltap-test"}) {
      EXPECT_EQ(text.find(name), std::string::npos) << name;
    }
    EXPECT_EQ(fs::status(kept().front().parent_path()).permissions(), fs::perms::owner_all);
    ::kill(static_cast<pid_t>(program.processId()), SIGKILL);
    ASSERT_TRUE(program.waitForFinished());
  }
  ASSERT_FALSE(kept_work().is_null());

  QProcess program;
  start(program, {});
  ASSERT_TRUE(window("SpinalTap planner"));
  let_work(500);
  ASSERT_TRUE(window("SpinalTap planner"));  // the question, on top
  input.key("Return");
  ASSERT_TRUE(window("New plan* - SpinalTap planner"));
  ASSERT_TRUE(wait_until([&] { return kept().size() == 2; }));  // its own in place of the lost, with a lock
  input.key("ctrl+s");
  const fs::path saved = folder.path() / "saved.json";
  name_file(saved, "Save the plan");
  const std::vector<DrillPath> paths = read_plan(saved);
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].name, phantom_paths()[1].name);
  EXPECT_EQ(paths[0].entry_mm, phantom_paths()[1].entry_mm);
  EXPECT_EQ(paths[0].target_mm, phantom_paths()[1].target_mm);

  ASSERT_TRUE(window("saved.json - SpinalTap planner"));
  const fs::path record = folder.path() / "record.h5";
  // The hole is drilled again, which takes a moment.
  ASSERT_TRUE(wait_until(
      [&] {
        if (!input.give_keyboard("Save the record").isEmpty()) return true;
        if (input.give_keyboard("saved.json - SpinalTap planner").isEmpty()) return false;
        input.key("ctrl+alt+s");
        let_work(500);
        return false;
      },
      120000));
  name_file(record, "Save the record");
  const auto recorded = [&]() -> std::size_t {
    try {
      const SessionRecord read = read_record(record);
      return read.is_whole ? read.cycles.size() : 0;
    } catch (const Error&) {  // it is being written
      return 0;
    }
  };
  EXPECT_TRUE(wait_until(
      [&] {
        let_work(200);
        return recorded() == cycles;
      },
      60000))
      << recorded() << " cycles, expected " << cycles;

  // A clean end leaves nothing.
  ASSERT_TRUE(window("saved.json - SpinalTap planner"));
  let_work(500);
  input.key("ctrl+q");
  ASSERT_TRUE(program.waitForFinished());
  EXPECT_EQ(program.exitStatus(), QProcess::NormalExit);
  EXPECT_EQ(program.exitCode(), 0);
  EXPECT_THAT(kept(), testing::IsEmpty());
}

TEST(PlannerAutosave, KeepsAMillingItselfAndTheEngineThatWasChosen) {
  const TemporaryFolder folder;
  const QByteArray before = qgetenv("XDG_STATE_HOME");
  qputenv("XDG_STATE_HOME", folder.path().string().c_str());
  {
    Planner planner;
    planner.document().set_bone(phantom_bone());
    planner.document().set_paths({burr_path()});
    Autosave autosave(planner);
    HoleOrder milled{burr_path(), {}, 7};
    milled.plan.tool_operator = "milling";
    milled.plan.milling = std::make_shared<const Milling>(entry_milling());
    HoleOrder drilled{phantom_paths().front(), {}, 9};
    drilled.plan.engine = EngineKind::voxel;
    planner.player().drill_again({milled, drilled});
    autosave.keep({milled, drilled});
    // As if this window's file were a crashed one's: its own is held by its lock.
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(work_folder())) files.push_back(entry.path());
    for (const fs::path& file : files) {
      if (file.extension() == ".json") fs::copy_file(file, work_folder() / "crashed.json");
    }
    const std::vector<LostWork> lost = lost_work();
    EXPECT_EQ(lost.size(), 1U);
    if (lost.size() == 1 && lost[0].holes.size() == 2) {
      const HoleOrder& first = lost[0].holes[0];
      EXPECT_EQ(first.plan.tool_operator, "milling");
      EXPECT_EQ(first.plan.engine, EngineKind::automatic);
      EXPECT_TRUE(first.plan.milling);
      if (first.plan.milling) {
        EXPECT_EQ(first.plan.milling->outline_mm, entry_milling().outline_mm);
        EXPECT_EQ(first.plan.milling->name, "patch");
      }
      EXPECT_EQ(lost[0].holes[1].plan.engine, EngineKind::voxel);
      EXPECT_FALSE(lost[0].holes[1].plan.milling);
    } else {
      ADD_FAILURE() << "expected the two holes";
    }
  }
  if (before.isNull()) {
    qunsetenv("XDG_STATE_HOME");
  } else {
    qputenv("XDG_STATE_HOME", before);
  }
}

}  // namespace
}  // namespace spinaltap::test

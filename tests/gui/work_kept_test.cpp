// What a person has done and not saved, and what could take it away.
#include <gmock/gmock.h>

#include <QTableWidget>
#include <chrono>
#include <thread>

#include "core/base/staged_output.h"
#include "core/files/plan_file.h"
#include "core/session/record/session_record.h"
#include "tests/gui/planner_window.h"

namespace spinaltap::test {
namespace {

class WorkKept : public PlannerWindow {
 protected:
  /// A hole along the chosen path, to its end.
  void drill() {
    planner().player().start({.feed_mm_s = 10.0, .speed = 0.0});
    ASSERT_TRUE(wait_until([&] { return planner().player().state() == DrillPlayer::State::stopped; }, 120000));
  }
  /// Types a name into the dialog for files that opens next, then does `then`.
  void name_file(const std::filesystem::path& file, std::function<void()> then = {}) {
    in_the_next_dialog([this, file, then = std::move(then)] {
      input.key("ctrl+a");
      input.type(text_of(file.string()));
      if (then) then();
      input.key("Return");
    });
  }
  bool has_box() { return QApplication::activeModalWidget() != nullptr; }
};

TEST_F(WorkKept, EditsMadeWhileABoneOpensAreAskedAbout) {
  show_phantom();
  window->open(phantom_file());
  ASSERT_TRUE(planner().job().is_running());
  document().remove_path(1);
  answer_box(QMessageBox::Cancel);
  ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty(); }, 60000));
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("not saved"));
  let_work(200);
  EXPECT_EQ(document().bone(), phantom_bone());
  EXPECT_EQ(document().paths().size(), 1U);

  answer_box(QMessageBox::Discard);
  window->open(phantom_file());
  EXPECT_FALSE(box_text.isEmpty());
  document().move_end(0, PathEnd::target, document().paths()[0].target_mm + Vec3(0.0, 0.0, 0.4));
  answer_box(QMessageBox::Discard);
  ASSERT_TRUE(wait_until([&] { return document().bone() != phantom_bone(); }, 60000));
  EXPECT_FALSE(box_text.isEmpty());
  EXPECT_TRUE(document().paths().empty());
}

TEST_F(WorkKept, WhatThePersonGaveUpIsNotAskedForTwice) {
  show_phantom();
  document().remove_path(1);
  answer_box(QMessageBox::Discard);
  window->open(phantom_file());
  EXPECT_FALSE(box_text.isEmpty());
  ASSERT_TRUE(wait_until([&] { return document().bone() != phantom_bone() || has_box(); }, 60000));
  EXPECT_FALSE(has_box());
  EXPECT_TRUE(document().paths().empty());
}

TEST_F(WorkKept, ASaveAsksBeforeItReplacesAFileWhoseEndingWasAdded) {
  show_phantom();
  const std::filesystem::path file = folder.path() / "plan.json";
  write_whole_file(file, "mine");
  QString replaced;
  const auto answer = [&](QMessageBox::StandardButton button, std::function<void()> then) {
    return [this, &replaced, button, then = std::move(then)] {
      in_the_next_dialog([&replaced, button, then] {
        auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
        if (box == nullptr) return;
        replaced = box->text();
        if (then) then();
        box->button(button)->click();
      });
    };
  };
  name_file(folder.path() / "plan", answer(QMessageBox::No, [&] { in_the_next_dialog([&] { input.key("Escape"); }); }));
  input.key("ctrl+shift+s");
  ASSERT_TRUE(wait_until([&] { return !replaced.isEmpty() && !has_box(); }));
  EXPECT_THAT(replaced.toStdString(), testing::HasSubstr("plan.json"));
  EXPECT_EQ(read_whole_file(file), "mine");

  replaced.clear();
  take_keyboard_back();
  name_file(folder.path() / "plan", answer(QMessageBox::Yes, {}));
  input.key("ctrl+shift+s");
  ASSERT_TRUE(wait_until([&] { return !replaced.isEmpty() && !has_box(); }));
  EXPECT_EQ(read_plan(file).size(), 2U);
}

TEST_F(WorkKept, ThePlansOwnFileIsNotReplacedUnaskedWhereAnotherProgramChangedIt) {
  show_phantom();
  const std::filesystem::path file = folder.path() / "plan.json";
  planner().save_plan(file);
  document().remove_path(1);
  write_whole_file(file, "another's");
  std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now() + std::chrono::seconds(5));
  answer_box(QMessageBox::No);
  input.key("ctrl+s");
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("Another program"));
  EXPECT_EQ(read_whole_file(file), "another's");
  take_keyboard_back();
  answer_box(QMessageBox::Yes);
  input.key("ctrl+s");
  ASSERT_TRUE(wait_until([&] { return !planner().has_unsaved_changes(); }));
  EXPECT_EQ(read_plan(file).size(), 1U);
}

TEST_F(WorkKept, ClosingAsksForADrillingAndSavesItsRecord) {
  show_phantom();
  drill();
  answer_box(QMessageBox::Cancel);
  window->close();
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("drilling is not saved"));
  EXPECT_TRUE(window->isVisible());

  const std::filesystem::path record = folder.path() / "drilling.h5";
  in_the_next_dialog([&] {
    name_file(record);
    qobject_cast<QMessageBox*>(QApplication::activeModalWidget())->button(QMessageBox::Save)->click();
  });
  const std::size_t cycles = planner().player().done()->inputs.size();
  window->close();
  ASSERT_TRUE(wait_until([&] { return !window->isVisible(); }, 60000));  // by itself, once it is written
  EXPECT_EQ(read_record(record).cycles.size(), cycles);
}

TEST_F(WorkKept, OpeningAnotherBoneAsksForADrillingAndAnotherPlanDoesNot) {
  show_phantom();
  drill();
  const std::filesystem::path plan = folder.path() / "plan.json";
  write_plan(phantom_paths(), plan);
  window->open(plan);
  EXPECT_FALSE(has_box());
  EXPECT_TRUE(planner().player().has_unsaved());
  answer_box(QMessageBox::Cancel);
  window->open(phantom_file());
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("drilling is not saved"));
  EXPECT_FALSE(planner().job().is_running());

  planner().save_record(folder.path() / "drilling.h5");
  ASSERT_TRUE(wait_until([&] { return !planner().job().is_running(); }, 60000));
  EXPECT_FALSE(planner().player().has_unsaved());
  box_text.clear();
  window->open(phantom_file());
  ASSERT_TRUE(wait_until([&] { return document().bone() != phantom_bone() || has_box(); }, 60000));
  EXPECT_FALSE(has_box());
}

/// Holds what a background job tells back until something is so: it may be done in no time.
class ToldLater : public QObject {
 public:
  ToldLater(BackgroundJob& job, std::function<bool()> when) : when_(std::move(when)) { job.installEventFilter(this); }

 protected:
  bool eventFilter(QObject* object, QEvent* event) override {
    if (event->type() == QEvent::MetaCall) wait_until(when_, 60000);
    return QObject::eventFilter(object, event);
  }

 private:
  std::function<bool()> when_;
};

TEST_F(WorkKept, ADrillingThatBeginsWhileABoneOpensIsAskedAbout) {
  show_phantom();
  ToldLater opened(planner().job(), [&] { return planner().player().state() == DrillPlayer::State::drilling; });
  answer_box(QMessageBox::Cancel);
  window->open(phantom_file());
  planner().player().start({.speed = 1.0});
  ASSERT_TRUE(wait_until([&] { return !box_text.isEmpty(); }, 60000));
  EXPECT_THAT(box_text.toStdString(), testing::HasSubstr("drilling is not saved"));
  EXPECT_EQ(document().bone(), phantom_bone());
  planner().player().stop();
}

}  // namespace
}  // namespace spinaltap::test

#pragma once

#include <gtest/gtest.h>

#include <QAbstractButton>
#include <QApplication>
#include <QDragEnterEvent>
#include <QLabel>
#include <QMessageBox>
#include <QMimeData>
#include <QSettings>
#include <QTimer>
#include <QUrl>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "apps/spinaltap-planner/slices/slice_view.h"
#include "apps/spinaltap-planner/window/four_panes.h"
#include "apps/spinaltap-planner/window/main_window.h"
#include "apps/spinaltap-planner/window/words.h"
#include "tests/gui/phantom_bone.h"
#include "tests/gui/x_input.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap::test {

/// The window on a display, with settings of its own, and a mouse and keyboard for it.
class PlannerWindow : public testing::Test {
 protected:
  void SetUp() override {
    QSettings::setPath(QSettings::NativeFormat, QSettings::UserScope, text_of(folder.path().string()));
    QSettings().clear();
    window = std::make_unique<MainWindow>();
    window->resize(1400, 900);
    input.show(*window);
    QObject::connect(&each_second_, &QTimer::timeout, [this] { close_what_nobody_answers(); });
    each_second_.start(1000);
  }

  Planner& planner() { return window->planner(); }
  PlanDocument& document() { return planner().document(); }
  SliceView& slice(const char* name) { return dynamic_cast<SliceView&>(*window->panes().pane(name)); }
  template <class Widget>
  Widget& child(const char* name) {
    auto* found = window->findChild<Widget*>(name);
    if (found == nullptr) throw std::runtime_error(std::string("the window has no ") + name);
    return *found;
  }

  /// The phantom and its two paths, as after opening both files.
  void show_phantom(bool with_paths = true) {
    document().set_bone(phantom_bone());
    if (with_paths) document().set_paths(phantom_paths());
    if (with_paths) planner().view().set_crosshair(document().chosen_path()->entry_mm);
    let_work(100);
  }
  /// Where a place in the patient is in a slice's pane.
  static QPoint pixel_of(const SliceView& view, const Vec3& p_mm) { return view.place_of(p_mm).toPoint(); }
  static double mm_per_pixel(const SliceView& view) { return view.frame().pixel_mm * view.devicePixelRatioF(); }
  QString status() { return child<QLabel>("hover").text(); }
  /// A file or a folder, from another program. The window opens it when it is back at its events.
  void drop(const std::filesystem::path& file) {
    QMimeData data;
    data.setUrls({QUrl::fromLocalFile(text_of(file.string()))});
    QDragEnterEvent enter(QPoint(100, 100), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(window.get(), &enter);
    EXPECT_TRUE(enter.isAccepted());
    QDropEvent drop(QPointF(100, 100), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(window.get(), &drop);
  }

  /// There is no window manager to give the keyboard back when a dialog has closed.
  void take_keyboard_back() { input.show(*window); }
  /// Does something in the next dialog that opens; it holds up whoever opened it.
  void in_the_next_dialog(std::function<void()> work, int tries = 24000) {
    QTimer::singleShot(5, &timer_, [this, work = std::move(work), tries] {
      QWidget* dialog = QApplication::activeModalWidget();
      if (dialog != nullptr && dialog->isActiveWindow()) {
        work();
      } else if (tries > 0) {
        // A box that opens while another closes is not always given the keyboard; a window manager would.
        constexpr int kPatience = 400;
        if (dialog != nullptr && tries % kPatience == 0) dialog->activateWindow();
        in_the_next_dialog(work, tries - 1);
      }
    });
  }
  /// Presses a button of the next box that opens, its first where none is named, and keeps what it said.
  void answer_box(QMessageBox::StandardButton button) {
    box_text.clear();
    in_the_next_dialog([this, button] {
      auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
      if (box == nullptr) return;
      box_text = box->text() + "\n" + box->informativeText();
      QAbstractButton* pressed = button == QMessageBox::NoButton ? box->buttons().front() : box->button(button);
      if (pressed != nullptr) pressed->click();
    });
  }

  TemporaryFolder folder;
  XInput input;
  std::unique_ptr<MainWindow> window;
  QString box_text;

 private:
  /// A dialog that a test did not expect would hold it up for ever.
  void close_what_nobody_answers() {
    constexpr int kLongestS = 150;
    QWidget* const dialog = QApplication::activeModalWidget();
    waited_s_ = dialog != nullptr && dialog == unanswered_ ? waited_s_ + 1 : 0;
    unanswered_ = dialog;
    if (waited_s_ < kLongestS) return;
    const auto* box = qobject_cast<QMessageBox*>(dialog);
    ADD_FAILURE() << "nobody answers " << (box != nullptr ? box->text() : dialog->windowTitle()).toStdString();
    dialog->close();
  }

  QObject timer_;
  QTimer each_second_;
  const QWidget* unanswered_ = nullptr;
  int waited_s_ = 0;
};

}  // namespace spinaltap::test

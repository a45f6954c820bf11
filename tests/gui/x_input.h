#pragma once

#include <QPoint>
#include <QString>
#include <QStringList>
#include <functional>

class QWidget;

namespace spinaltap::test {

/// Waits, while the window works, until something is so; false after `longest_ms`.
bool wait_until(const std::function<bool()>& is_so, int longest_ms = 10000);
/// Lets the window work for a while.
void let_work(int ms);

enum class MouseButton { left = 1, middle = 2, right = 3 };

/// A real mouse and keyboard: events go to the X server, which gives them to the window under the pointer, as it does
/// with a person's. Places are logical pixels of a widget.
class XInput {
 public:
  XInput();
  ~XInput();
  XInput(const XInput&) = delete;
  XInput& operator=(const XInput&) = delete;

  /// Shows the window and waits until it has the keyboard.
  void show(QWidget& window);
  /// Gives the keyboard to the topmost window, of any program, whose title holds these words. Returns its title; empty:
  /// there is none.
  QString give_keyboard(const QString& words);
  /// The titles of all windows that are seen, of any program, the topmost first; empty where one has none.
  QStringList titles();
  /// Moves the pointer, in steps as a hand does.
  void move(QWidget& widget, const QPoint& to);
  /// Moves it at one go.
  void nudge(QWidget& widget, const QPoint& to);
  void press(MouseButton button = MouseButton::left);
  void release(MouseButton button = MouseButton::left);
  void click(QWidget& widget, const QPoint& at, MouseButton button = MouseButton::left);
  void click(QWidget& widget);
  void double_click(QWidget& widget, const QPoint& at);
  void drag(QWidget& widget, const QPoint& from, const QPoint& to, MouseButton button = MouseButton::left);
  /// Steps of the wheel under the pointer: above 0 away from the person.
  void wheel(int steps);
  /// Keys as X names them: "a", "Return", "Page_Down"; "ctrl+", "shift+" and "alt+" before it are held.
  void key(const QString& name);
  /// While `work` runs, a modifier is held: "ctrl", "shift", "alt".
  void hold(const QString& modifier, const std::function<void()>& work);
  void type(const QString& text);

 private:
  struct State;
  State* state_;
};

}  // namespace spinaltap::test

#include "tests/gui/x_input.h"

#include <QAbstractNativeEventFilter>
#include <QApplication>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QThread>
#include <QWidget>
#include <QWindow>
#include <optional>
#include <stdexcept>

// Last: X11 defines words such as None and Bool.
#include <X11/XKBlib.h>
#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/extensions/XTest.h>
#include <X11/keysym.h>
#include <xcb/xcb.h>

namespace spinaltap::test {

bool wait_until(const std::function<bool()>& is_so, int longest_ms) {
  QElapsedTimer clock;
  clock.start();
  while (!is_so()) {
    if (clock.elapsed() > longest_ms) return false;
    QApplication::processEvents(QEventLoop::AllEvents, 10);
    QApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
    QThread::msleep(1);
  }
  return true;
}

void let_work(int ms) {
  QElapsedTimer clock;
  clock.start();
  wait_until([&] { return clock.elapsed() >= ms; }, 2 * ms + 100);
}

namespace {

QString title_of(Display* display, Window window) {
  Atom type = 0;
  int format = 0;
  unsigned long count = 0, rest = 0;
  unsigned char* text = nullptr;
  const Atom name = XInternAtom(display, "_NET_WM_NAME", False), utf8 = XInternAtom(display, "UTF8_STRING", False);
  constexpr long kMaxWords = 256;
  if (XGetWindowProperty(display, window, name, 0, kMaxWords, False, utf8, &type, &format, &count, &rest, &text) !=
          Success ||
      text == nullptr) {
    return {};
  }
  const QString title = QString::fromUtf8(reinterpret_cast<const char*>(text), static_cast<int>(count));
  XFree(text);
  return title;
}

/// Notes when the program's own connection to the server has come to a mark, a property of one of its windows: events
/// come in their order, so all that were made before are here then.
class Mark final : public QAbstractNativeEventFilter {
 public:
  explicit Mark(Display* display) : display_(display), atom_(XInternAtom(display, "SPINALTAP_TEST_MARK", False)) {
    qApp->installNativeEventFilter(this);
  }
  ~Mark() override {
    if (qApp != nullptr) qApp->removeNativeEventFilter(this);
  }
  Mark(const Mark&) = delete;
  Mark& operator=(const Mark&) = delete;

  /// Waits for it, where the program has a window.
  void pass() {
    WId seen = 0;
    for (const QWindow* window : QGuiApplication::topLevelWindows()) {
      if (window->isVisible() && window->handle() != nullptr) seen = window->winId();
    }
    if (seen == 0) return;
    is_passed_ = false;
    const unsigned char nothing = 0;
    XChangeProperty(display_, seen, atom_, XA_INTEGER, 8, PropModeReplace, &nothing, 1);
    XSync(display_, False);
    constexpr int kLongestMs = 2000;  // a window may close before it hears of it
    wait_until([this, seen] { return is_passed_ || !has_window(seen); }, kLongestMs);
  }

#if QT_VERSION >= QT_VERSION_CHECK(6, 0, 0)
  using Result = qintptr;
#else
  using Result = long;
#endif
  bool nativeEventFilter(const QByteArray& kind, void* message, Result* /*result*/) override {
    if (kind != "xcb_generic_event_t") return false;
    const auto* event = static_cast<const xcb_generic_event_t*>(message);
    constexpr unsigned kSentBit = 0x80;
    if ((event->response_type & ~kSentBit) != XCB_PROPERTY_NOTIFY) return false;
    is_passed_ |= static_cast<const xcb_property_notify_event_t*>(message)->atom == atom_;
    return false;
  }

 private:
  static bool has_window(WId id) {
    for (const QWindow* window : QGuiApplication::topLevelWindows()) {
      if (window->handle() != nullptr && window->winId() == id) return true;
    }
    return false;
  }

  Display* display_;
  Atom atom_;
  bool is_passed_ = false;
};

/// Windows come and go while they are looked at.
int pass_over_errors(Display* /*display*/, XErrorEvent* /*error*/) { return 0; }

}  // namespace

struct XInput::State {
  Display* display = nullptr;
  std::optional<Mark> mark;

  /// Calls `visit(window, title)` for the windows of all programs that are seen, from the top down, until it returns
  /// true.
  template <typename Visit>
  void windows(const Visit& visit) {
    const auto before = XSetErrorHandler(pass_over_errors);
    Window root = 0, parent = 0, *all = nullptr;
    unsigned count = 0;
    XQueryTree(display, DefaultRootWindow(display), &root, &parent, &all, &count);
    for (unsigned n = count; n > 0; --n) {
      XWindowAttributes attributes;
      if (XGetWindowAttributes(display, all[n - 1], &attributes) == 0 || attributes.map_state != IsViewable) continue;
      if (visit(all[n - 1], title_of(display, all[n - 1]))) break;
    }
    if (all != nullptr) XFree(all);
    XSync(display, False);  // errors come late
    XSetErrorHandler(before);
  }

  /// Until the window has all events that the server made of ours, also where the machine is busy.
  void sync() {
    const auto before = XSetErrorHandler(pass_over_errors);
    XSync(display, False);
    QGuiApplication::sync();
    mark->pass();
    XSetErrorHandler(before);
    let_work(8);
  }
  /// Only with sync() is it sent: a key goes down and up in one message. Where a busy machine stood still in between,
  /// the server would take it for held, and repeat it.
  void key(KeySym symbol, bool is_down) {
    const KeyCode code = XKeysymToKeycode(display, symbol);
    if (code == 0) throw std::runtime_error("the keyboard has no such key");
    XTestFakeKeyEvent(display, code, is_down ? True : False, CurrentTime);
  }
};

XInput::XInput() : state_(new State) {
  state_->display = XOpenDisplay(nullptr);
  if (state_->display == nullptr) {
    delete state_;
    throw std::runtime_error("no X display: run the tests under xvfb-run");
  }
  state_->mark.emplace(state_->display);
}

XInput::~XInput() {
  state_->mark.reset();
  XCloseDisplay(state_->display);
  delete state_;
}

void XInput::show(QWidget& window) {
  window.move(0, 0);
  window.show();
  wait_until([&] { return window.windowHandle() != nullptr && window.windowHandle()->isExposed(); });
  // There is no window manager to give it the keyboard.
  XSetInputFocus(state_->display, window.winId(), RevertToParent, CurrentTime);
  window.activateWindow();
  state_->sync();
  if (!wait_until([&] { return window.isActiveWindow(); })) throw std::runtime_error("the window got no keyboard");
}

QString XInput::give_keyboard(const QString& words) {
  QString found;
  state_->windows([&](Window window, const QString& title) {
    if (!title.contains(words)) return false;
    XSetInputFocus(state_->display, window, RevertToParent, CurrentTime);
    found = title;
    return true;
  });
  state_->sync();
  return found;
}

QStringList XInput::titles() {
  QStringList all;
  state_->windows([&](Window /*window*/, const QString& title) {
    all << title;
    return false;
  });
  return all;
}

void XInput::move(QWidget& widget, const QPoint& to) {
  const QPoint place = widget.mapToGlobal(to) * widget.devicePixelRatioF();
  const QPoint from = QCursor::pos() * widget.devicePixelRatioF();
  constexpr int kSteps = 6;
  for (int step = 1; step <= kSteps; ++step) {
    const QPoint at = from + (place - from) * step / kSteps;
    XTestFakeMotionEvent(state_->display, -1, at.x(), at.y(), CurrentTime);
    state_->sync();
  }
}

void XInput::nudge(QWidget& widget, const QPoint& to) {
  const QPoint place = widget.mapToGlobal(to) * widget.devicePixelRatioF();
  XTestFakeMotionEvent(state_->display, -1, place.x(), place.y(), CurrentTime);
  XSync(state_->display, False);
}

void XInput::press(MouseButton button) {
  XTestFakeButtonEvent(state_->display, static_cast<unsigned>(button), True, CurrentTime);
  state_->sync();
}

void XInput::release(MouseButton button) {
  XTestFakeButtonEvent(state_->display, static_cast<unsigned>(button), False, CurrentTime);
  state_->sync();
}

void XInput::click(QWidget& widget, const QPoint& at, MouseButton button) {
  move(widget, at);
  press(button);
  release(button);
  let_work(20);
}

void XInput::click(QWidget& widget) { click(widget, widget.rect().center()); }

void XInput::double_click(QWidget& widget, const QPoint& at) {
  move(widget, at);
  for (int n = 0; n < 2; ++n) {
    press();
    release();
  }
  let_work(20);
}

void XInput::drag(QWidget& widget, const QPoint& from, const QPoint& to, MouseButton button) {
  move(widget, from);
  press(button);
  move(widget, to);
  release(button);
  let_work(20);
}

void XInput::wheel(int steps) {
  const unsigned button = steps > 0 ? Button4 : Button5;
  for (int n = 0; n < std::abs(steps); ++n) {
    XTestFakeButtonEvent(state_->display, button, True, CurrentTime);
    XTestFakeButtonEvent(state_->display, button, False, CurrentTime);
    XSync(state_->display, False);
    if (std::abs(steps) > 1) let_work(8);
  }
  if (std::abs(steps) > 1) let_work(20);
}

namespace {

KeySym modifier_symbol(const QString& name) {
  if (name == "ctrl") return XK_Control_L;
  if (name == "shift") return XK_Shift_L;
  return XK_Alt_L;
}

}  // namespace

void XInput::key(const QString& name) {
  QStringList parts = name.split('+');
  const KeySym symbol = XStringToKeysym(parts.takeLast().toLatin1().constData());
  for (const QString& modifier : parts) state_->key(modifier_symbol(modifier), true);
  state_->key(symbol, true);
  state_->key(symbol, false);
  for (const QString& modifier : parts) state_->key(modifier_symbol(modifier), false);
  state_->sync();
  let_work(25);
}

void XInput::hold(const QString& modifier, const std::function<void()>& work) {
  state_->key(modifier_symbol(modifier), true);
  state_->sync();
  work();
  state_->key(modifier_symbol(modifier), false);
  state_->sync();
  let_work(20);
}

void XInput::type(const QString& text) {
  for (const QChar c : text) {
    const KeySym symbol = c.unicode();  // Latin letters are their own symbols
    const KeyCode code = XKeysymToKeycode(state_->display, symbol);
    const bool is_shifted = XkbKeycodeToKeysym(state_->display, code, 0, 0) != symbol;
    if (is_shifted) state_->key(XK_Shift_L, true);
    state_->key(symbol, true);
    state_->key(symbol, false);
    if (is_shifted) state_->key(XK_Shift_L, false);
  }
  state_->sync();
  let_work(25);
}

}  // namespace spinaltap::test

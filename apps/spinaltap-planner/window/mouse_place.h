#pragma once

#include <QMouseEvent>

namespace spinaltap {

/// Where the mouse is in the widget that is told of it, in its pixels. Qt 5 and 6 name it differently.
inline QPointF mouse_in_widget(const QMouseEvent& event) {
#if QT_VERSION >= QT_VERSION_CHECK(6, 0, 0)
  return event.position();
#else
  return event.localPos();
#endif
}

/// And on the screen.
inline QPoint mouse_on_screen(const QMouseEvent& event) {
#if QT_VERSION >= QT_VERSION_CHECK(6, 0, 0)
  return event.globalPosition().toPoint();
#else
  return event.globalPos();
#endif
}

}  // namespace spinaltap

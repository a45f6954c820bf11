#include "apps/spinaltap-planner/window/wheel_needs_focus.h"

#include <QAbstractSlider>
#include <QAbstractSpinBox>
#include <QApplication>
#include <QComboBox>
#include <QEvent>
#include <QScrollBar>

namespace spinaltap {
namespace {

bool turns_by_wheel(const QObject* object) {
  if (qobject_cast<const QScrollBar*>(object) != nullptr) return false;
  return qobject_cast<const QAbstractSpinBox*>(object) != nullptr ||
         qobject_cast<const QComboBox*>(object) != nullptr || qobject_cast<const QAbstractSlider*>(object) != nullptr;
}

}  // namespace

WheelNeedsFocus::WheelNeedsFocus(QObject* parent) : QObject(parent) {
  QCoreApplication::instance()->installEventFilter(this);
}

bool WheelNeedsFocus::eventFilter(QObject* object, QEvent* event) {
  const QEvent::Type type = event->type();
  if ((type != QEvent::Polish && type != QEvent::Wheel) || !turns_by_wheel(object)) {
    return QObject::eventFilter(object, event);
  }
  auto* widget = qobject_cast<QWidget*>(object);
  if (type == QEvent::Polish) {
    // Qt would give the keyboard to what the wheel is turned over.
    if (widget->focusPolicy() == Qt::WheelFocus) widget->setFocusPolicy(Qt::StrongFocus);
  } else if (!widget->hasFocus()) {
    event->ignore();  // goes on to the page
    return true;
  }
  return QObject::eventFilter(object, event);
}

}  // namespace spinaltap

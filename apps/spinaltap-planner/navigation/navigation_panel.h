#pragma once

#include <QWidget>
#include <functional>
#include <map>
#include <memory>

#include "apps/spinaltap-planner/drill/drill_player.h"
#include "apps/spinaltap-planner/navigation/bulls_eye_view.h"
#include "apps/spinaltap-planner/navigation/navigation_source.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QLineEdit;
class QProgressBar;
class QPushButton;

namespace spinaltap {

/// The navigation picture: who moves the tool, the view down the bit, how far the tool is from the plan, from walls and
/// from the target, and what it feels. Shows whatever the player drills. For a dock.
class NavigationPanel : public QWidget {
  Q_OBJECT
 public:
  /// All must outlive this.
  NavigationPanel(PlanDocument& document, ViewState& view, DrillPlayer& player, QWidget* parent = nullptr);

  /// Sources by name: "hand" (keyboard and mouse), "device" (address: a plug-in or loopback, as open_device() has it),
  /// "listen" (a port), "connect" (HOST:PORT), "record" (a file). Starts it along the chosen path. Throws Error.
  void start(const QString& source, const QString& address);

 Q_SIGNALS:
  void failed(const QString& why);

 private:
  QWidget* make_choices();
  QWidget* make_figures();
  QLabel* add_figure(const char* name, const QString& title, int row, int column);
  std::shared_ptr<NavigationSource> make_source(const QString& source, const QString& address) const;
  void press_start();
  void choose_source();
  void enable();
  void show_progress();
  void show_state(const std::optional<NavigationFigures>& figures);

  PlanDocument& document_;
  ViewState& view_;
  DrillPlayer& player_;
  QComboBox* source_ = nullptr;
  QLineEdit* address_ = nullptr;
  QPushButton* start_ = nullptr;
  QCheckBox* follows_ = nullptr;
  BullsEyeView* bulls_eye_ = nullptr;
  QWidget* figures_ = nullptr;
  QLabel *entry_ = nullptr, *target_ = nullptr, *tip_ = nullptr, *angle_ = nullptr;
  QLabel *left_ = nullptr, *hand_ = nullptr, *outer_ = nullptr, *canal_ = nullptr;
  QLabel* state_ = nullptr;
  QProgressBar* force_ = nullptr;
};

}  // namespace spinaltap

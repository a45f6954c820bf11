#pragma once

#include <QWidget>
#include <cstddef>

#include "apps/spinaltap-planner/drill/drill_player.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QListWidget;
class QToolButton;

namespace spinaltap {

class DrillFiguresView;
class PlotView;

/// Drills the chosen path and shows how it goes: the operator and its pace, buttons, figures, a curve along the depth,
/// and what happened. For a dock.
class DrillPanel : public QWidget {
  Q_OBJECT
 public:
  /// Both must outlive this.
  DrillPanel(PlanDocument& document, DrillPlayer& player, QWidget* parent = nullptr);

  /// As chosen in the panel.
  DrillPlan plan() const;

 Q_SIGNALS:
  void save_record_wanted();
  void write_report_wanted();

 private:
  QWidget* make_choices();
  void show_plan();
  QWidget* make_buttons();
  QToolButton* make_button(const char* name, const QString& text, const QString& tip, const QKeySequence& key);
  void enable();
  void show_progress();
  void show_plot();
  void show_events();

  PlanDocument& document_;
  DrillPlayer& player_;
  QComboBox* operator_ = nullptr;
  QDoubleSpinBox* feed_ = nullptr;
  QDoubleSpinBox* push_ = nullptr;
  QComboBox* speed_ = nullptr;
  QCheckBox* stops_ = nullptr;
  QToolButton *drill_ = nullptr, *go_on_ = nullptr, *back_ = nullptr;
  QToolButton *undo_ = nullptr, *redo_ = nullptr, *record_ = nullptr, *report_ = nullptr;
  DrillFiguresView* figures_ = nullptr;
  QComboBox* curve_ = nullptr;
  PlotView* plot_ = nullptr;
  QListWidget* events_ = nullptr;
  QLabel* trouble_ = nullptr;
};

}  // namespace spinaltap

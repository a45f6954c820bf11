#pragma once

#include <QWidget>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "apps/spinaltap-planner/drill/drill_player.h"
#include "apps/spinaltap-planner/sound/sound_output.h"

class QAction;
class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QListWidget;

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
  /// Chooses it, and the operator that mills so.
  void set_milling(const Milling& milling);
  /// What the buttons do, for a menu: their keys then work on every page.
  std::vector<QAction*> drilling_actions() const {
    return {drill_, go_on_, back_, undo_, redo_, record_, report_, choose_milling_};
  }

 Q_SIGNALS:
  void milling_wanted();
  void save_record_wanted();
  void write_report_wanted();

 private:
  QWidget* make_choices();
  void make_sound();
  void show_plan();
  QWidget* make_buttons();
  QAction* make_action(const char* name, const QString& text, const QString& tip, const QKeySequence& key,
                       const std::function<void()>& work);
  void enable();
  void show_progress();
  void let_hear();
  void show_plot();
  void show_events();

  PlanDocument& document_;
  DrillPlayer& player_;
  QComboBox* operator_ = nullptr;
  QDoubleSpinBox* feed_ = nullptr;
  QDoubleSpinBox* push_ = nullptr;
  QComboBox* engine_ = nullptr;
  QComboBox* speed_ = nullptr;
  QCheckBox* stops_ = nullptr;
  QCheckBox* sound_ = nullptr;
  QLabel* silence_ = nullptr;  ///< why nothing is heard
  SoundOutput sound_output_;
  QAction *drill_ = nullptr, *go_on_ = nullptr, *back_ = nullptr;
  QAction *undo_ = nullptr, *redo_ = nullptr, *record_ = nullptr, *report_ = nullptr;
  QAction* choose_milling_ = nullptr;
  std::shared_ptr<const Milling> milling_;
  DrillFiguresView* figures_ = nullptr;
  QComboBox* curve_ = nullptr;
  PlotView* plot_ = nullptr;
  QListWidget* events_ = nullptr;
  QLabel* trouble_ = nullptr;
};

}  // namespace spinaltap

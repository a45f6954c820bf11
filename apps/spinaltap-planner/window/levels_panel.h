#pragma once

#include <QWidget>

#include "apps/spinaltap-planner/ct_levels.h"
#include "apps/spinaltap-planner/plan_document.h"

class QLabel;
class QPushButton;
class QTableWidget;

namespace spinaltap {

/// The vertebrae of the open CT as a list: what is known of each, and whether it is baked. A click asks for one.
class LevelsPanel : public QWidget {
  Q_OBJECT
 public:
  /// `levels` and `document` must outlive it.
  LevelsPanel(CtLevels& levels, PlanDocument& document, QWidget* parent = nullptr);

 Q_SIGNALS:
  void wanted(int index);
  void all_wanted();

 private:
  void fill();
  void fill_row(int row);
  QString words() const;
  QString state_of(const CtLevel& level) const;

  CtLevels& levels_;
  PlanDocument& document_;
  double share_ = 0.0;  ///< of the bake that runs
  QLabel* words_ = nullptr;
  QTableWidget* list_ = nullptr;
  QPushButton* all_ = nullptr;
  QPushButton* find_ = nullptr;
};

}  // namespace spinaltap

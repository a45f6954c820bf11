#pragma once

#include <QWidget>
#include <vector>

class QLabel;

namespace spinaltap {

class DrillPlayer;

/// The figures of a drilling as it goes, in words, with their units.
class DrillFiguresView : public QWidget {
  Q_OBJECT
 public:
  explicit DrillFiguresView(QWidget* parent = nullptr);
  void show_figures(const DrillPlayer& player);

 private:
  QLabel* add(const char* name, const QString& label, int row, int column);

  QLabel *state_, *depth_, *thrust_, *torque_, *feed_, *removed_, *outer_, *canal_, *cycles_, *frames_;
};

/// What a clearance is called, in mm: "2.31 mm", "0.62 mm, near", "beyond by 0.40 mm"; "far" where no wall is near.
QString clearance_words(double clearance_mm);

}  // namespace spinaltap

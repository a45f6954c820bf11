#pragma once

#include <QWidget>

#include <span>
#include <vector>

#include "apps/report/svg_plot.h"
#include "core/session/cycle.h"
#include "core/session/depth_log.h"

class QLabel;

namespace spinaltap {

/// What is shown along the depth of a drilling.
enum class DrillCurve { thrust, torque, density, clearance, temperature };

/// Rows of a log as a curve, from the entry to the target of a path so long (mm) and as far as the rows reach.
Plot drill_plot(DrillCurve curve, std::span<const DepthRow> rows, double length_mm);

class DrillPlayer;

/// The figures of a drilling as it goes, in words, with their units.
class DrillFiguresView : public QWidget {
  Q_OBJECT
 public:
  explicit DrillFiguresView(QWidget* parent = nullptr);
  void show_figures(const DrillPlayer& player);

 private:
  QLabel* add(const char* name, const QString& label, int row, int column);

  QLabel *state_, *depth_, *thrust_, *torque_, *feed_, *removed_, *engine_, *outer_, *canal_, *heat_, *cycles_,
      *frames_;
};

/// What a clearance is called, in mm: "2.31 mm", "0.62 mm, near", "beyond by 0.40 mm"; "far" where no wall is near.
QString clearance_words(double clearance_mm);

}  // namespace spinaltap

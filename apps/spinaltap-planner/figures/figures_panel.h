#pragma once

#include <QWidget>
#include <vector>

#include "apps/report/svg_plot.h"

class QComboBox;
class QLabel;

namespace spinaltap {

struct PathFigures;
class PlotView;

/// The chosen path's grade, what stands out, why it was suggested, and plots along its depth.
class FiguresPanel : public QWidget {
  Q_OBJECT
 public:
  explicit FiguresPanel(QWidget* parent = nullptr);

  /// `hu_bands`: as PathGrader has them. Null: there is no path.
  void show_figures(const PathFigures* figures, const std::vector<double>& hu_bands);

 private:
  void show_plot();

  QLabel* grade_ = nullptr;
  QLabel* walls_ = nullptr;
  QLabel* warnings_ = nullptr;
  QLabel* reasons_ = nullptr;
  QComboBox* choice_ = nullptr;
  PlotView* plot_ = nullptr;
  std::vector<Plot> plots_;  ///< as the choice lists them
};

}  // namespace spinaltap

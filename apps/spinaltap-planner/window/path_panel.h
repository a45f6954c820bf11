#pragma once

#include <QWidget>
#include <vector>

#include "apps/spinaltap-planner/plan_document.h"
#include "core/files/bit_file.h"

class QAction;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QTableWidget;

namespace spinaltap {

struct PathFigures;

/// The plan's paths as a list, and the chosen one's tool and ends in numbers.
class PathPanel : public QWidget {
  Q_OBJECT
 public:
  /// Reads the sizes of screws and bits from the shipped files; throws Error where they are missing or damaged.
  explicit PathPanel(PlanDocument& document, QWidget* parent = nullptr);

  /// What the buttons above the list do.
  void set_actions(const std::vector<QAction*>& actions);
  /// The chosen path's figures; nothing is shown without a path.
  void show_figures(const PathFigures* figures);

 private:
  void fill_list();
  void fill_form();
  void rename(int row);
  void take_bit(int index);
  void take_bit_size();
  void take_screw(int index);
  void take_ends();

  PlanDocument& document_;
  bool is_filling_ = false;  ///< what changes now was not the person's doing
  std::vector<NamedBit> bits_;
  std::vector<PedicleScrew> screws_;
  QWidget* buttons_ = nullptr;
  QTableWidget* list_ = nullptr;
  QWidget* form_ = nullptr;
  QComboBox* bit_ = nullptr;
  QDoubleSpinBox* bit_diameter_ = nullptr;
  QDoubleSpinBox* bit_length_ = nullptr;
  QLabel* bit_thickness_ = nullptr;  ///< of plates
  QComboBox* screw_ = nullptr;
  QDoubleSpinBox* ends_[2][3] = {};  ///< entry and target, LPS
  QLabel* length_ = nullptr;
  QLabel* angles_ = nullptr;
};

}  // namespace spinaltap

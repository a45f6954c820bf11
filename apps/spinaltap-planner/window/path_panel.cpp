#include "apps/spinaltap-planner/window/path_panel.h"

#include <QAction>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QSignalBlocker>
#include <QTableWidget>
#include <QToolButton>
#include <QVBoxLayout>
#include <cmath>

#include "apps/spinaltap-planner/figures/path_figures.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"
#include "core/files/data_files.h"
#include "core/files/screw_file.h"

namespace spinaltap {
namespace {

constexpr double kMaxMm = 9999.0;  ///< of a coordinate

/// Undo and redo are the plan's, not those of the text in a box.
class PlanUndoInBox final : public QObject {
 public:
  explicit PlanUndoInBox(QAbstractSpinBox& box) : QObject(&box) {
    box.installEventFilter(this);
    for (QLineEdit* text : box.findChildren<QLineEdit*>()) text->installEventFilter(this);
  }

 protected:
  bool eventFilter(QObject* object, QEvent* event) override {
    if (event->type() == QEvent::ShortcutOverride) {
      const auto& key = dynamic_cast<const QKeyEvent&>(*event);
      if (key.matches(QKeySequence::Undo) || key.matches(QKeySequence::Redo)) {
        event->ignore();
        return true;
      }
    }
    return QObject::eventFilter(object, event);
  }
};

QDoubleSpinBox* mm_box(const char* name, double low, double high, double step, int decimals) {
  auto* box = new QDoubleSpinBox;
  box->setObjectName(QString::fromLatin1(name));
  box->setRange(low, high);
  box->setSingleStep(step);
  box->setDecimals(decimals);
  box->setKeyboardTracking(false);  // a number counts when it is whole
  box->setButtonSymbols(QAbstractSpinBox::NoButtons);
  box->setAlignment(Qt::AlignRight);
  new PlanUndoInBox(*box);  // the box's child
  return box;
}

QString tool_text(const DrillPath& path) { return text_of(tool_of(path)); }

}  // namespace

PathPanel::PathPanel(PlanDocument& document, QWidget* parent)
    : QWidget(parent),
      document_(document),
      bits_(shipped_bits()),
      screws_(read_screws(data_file("screws/pedicle.json"))) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(6, 6, 6, 0);
  buttons_ = new QWidget;
  layout->addWidget(buttons_);

  list_ = new QTableWidget(0, 3);
  list_->setObjectName("paths");
  list_->setAccessibleName(tr("Paths of the plan"));
  list_->setHorizontalHeaderLabels({tr("Path"), tr("Tool"), tr("mm")});
  list_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
  list_->horizontalHeader()->setSectionResizeMode(1, QHeaderView::Stretch);
  list_->horizontalHeader()->setSectionResizeMode(2, QHeaderView::ResizeToContents);
  list_->verticalHeader()->hide();
  list_->verticalHeader()->setDefaultSectionSize(22);
  list_->setSelectionBehavior(QAbstractItemView::SelectRows);
  list_->setSelectionMode(QAbstractItemView::SingleSelection);
  list_->setTabKeyNavigation(false);
  list_->setEditTriggers(QAbstractItemView::DoubleClicked | QAbstractItemView::AnyKeyPressed);
  list_->setToolTip(tr("Type a new name for the chosen path, or double click its name"));
  list_->setFixedHeight(116);
  layout->addWidget(list_);

  form_ = new QWidget;
  auto* form = new QFormLayout(form_);
  form->setContentsMargins(0, 0, 0, 0);
  form->setVerticalSpacing(3);
  bit_ = new QComboBox;
  bit_->setObjectName("bit");
  for (const NamedBit& bit : bits_) bit_->addItem(text_of(bit.name));
  bit_->addItem(tr("Other"));
  form->addRow(tr("&Bit"), bit_);
  auto* size = new QHBoxLayout;
  bit_diameter_ = mm_box("bitDiameter", 0.5, 20.0, 0.1, 2);
  bit_length_ = mm_box("bitLength", 5.0, 300.0, 1.0, 1);
  size->addWidget(bit_diameter_);
  size->addWidget(new QLabel(tr("mm wide,")));
  size->addWidget(bit_length_);
  size->addWidget(new QLabel(tr("mm long")));
  bit_thickness_ = new QLabel;
  bit_thickness_->setObjectName("bitThickness");
  size->addWidget(bit_thickness_);
  form->addRow(QString(), size);
  screw_ = new QComboBox;
  screw_->setObjectName("screw");
  screw_->addItem(tr("none"));
  for (const PedicleScrew& screw : screws_) screw_->addItem(text_of(screw.name));
  form->addRow(tr("Scre&w"), screw_);
  const char* const names[2][3] = {{"entryL", "entryP", "entryS"}, {"targetL", "targetP", "targetS"}};
  const QString labels[2] = {tr("Entr&y"), tr("&Target")};
  const char* const letters[3] = {"L ", "P ", "S "};
  for (int end = 0; end < 2; ++end) {
    auto* row = new QHBoxLayout;
    for (int axis = 0; axis < 3; ++axis) {
      ends_[end][axis] = mm_box(names[end][axis], -kMaxMm, kMaxMm, 0.1, 2);
      ends_[end][axis]->setPrefix(QLatin1String(letters[axis]));
      ends_[end][axis]->setToolTip(tr("mm; to the patient's left, back (posterior), head (superior)"));
      row->addWidget(ends_[end][axis]);
      connect(ends_[end][axis], qOverload<double>(&QDoubleSpinBox::valueChanged), this, [this] { take_ends(); });
    }
    form->addRow(labels[end], row);
    qobject_cast<QLabel*>(form->labelForField(row))->setBuddy(ends_[end][0]);
  }
  length_ = new QLabel;
  length_->setObjectName("length");
  form->addRow(tr("Length"), length_);
  angles_ = new QLabel;
  angles_->setObjectName("angles");
  angles_->setWordWrap(true);
  form->addRow(tr("Angles"), angles_);
  layout->addWidget(form_);

  connect(&document_, &PlanDocument::paths_changed, this, [this] {
    fill_list();
    fill_form();
  });
  connect(&document_, &PlanDocument::chosen_changed, this, [this] {
    fill_list();
    fill_form();
  });
  connect(list_, &QTableWidget::currentCellChanged, this, [this](int row) {
    if (!is_filling_ && row >= 0) document_.choose(row);
  });
  connect(list_, &QTableWidget::cellChanged, this, [this](int row) { rename(row); });
  connect(bit_, qOverload<int>(&QComboBox::activated), this, [this](int index) { take_bit(index); });
  connect(screw_, qOverload<int>(&QComboBox::activated), this, [this](int index) { take_screw(index); });
  for (QDoubleSpinBox* box : {bit_diameter_, bit_length_}) {
    connect(box, qOverload<double>(&QDoubleSpinBox::valueChanged), this, [this] { take_bit_size(); });
  }
  fill_list();
  fill_form();
}

void PathPanel::set_actions(const std::vector<QAction*>& actions) {
  auto* row = new QHBoxLayout(buttons_);
  row->setContentsMargins(0, 0, 0, 0);
  for (QAction* action : actions) {
    auto* button = new QToolButton;
    button->setDefaultAction(action);
    button->setToolButtonStyle(Qt::ToolButtonTextOnly);
    button->setFocusPolicy(Qt::StrongFocus);
    row->addWidget(button);
  }
  row->addStretch();
}

void PathPanel::show_figures(const PathFigures* figures) {
  if (figures == nullptr) {
    length_->clear();
    angles_->clear();
    return;
  }
  length_->setText(tr("%1 mm").arg(figures->graded.path.length_mm(), 0, 'f', 1));
  angles_->setText(tr("%1° to the midline, %2° %3; of the %4's planes")
                       .arg(figures->angles.convergence_deg, 0, 'f', 1)
                       .arg(std::abs(figures->angles.inclination_deg), 0, 'f', 1)
                       .arg(figures->angles.inclination_deg < 0.0 ? tr("down") : tr("up"))
                       .arg(figures->angles_are_the_vertebras ? tr("vertebra") : tr("patient")));
}

void PathPanel::fill_list() {
  is_filling_ = true;
  const std::vector<DrillPath>& paths = document_.paths();
  list_->setRowCount(static_cast<int>(paths.size()));
  for (int row = 0; row < list_->rowCount(); ++row) {
    const DrillPath& path = paths[static_cast<std::size_t>(row)];
    const QString texts[3] = {text_of(path.name), tool_text(path), QString::number(path.length_mm(), 'f', 1)};
    for (int column = 0; column < 3; ++column) {
      QTableWidgetItem* item = list_->item(row, column);
      if (item == nullptr) {
        item = new QTableWidgetItem;
        if (column != 0) item->setFlags(item->flags() & ~Qt::ItemIsEditable);
        list_->setItem(row, column, item);
      }
      if (item->text() != texts[column]) item->setText(texts[column]);
    }
  }
  if (list_->currentRow() != document_.chosen()) list_->setCurrentCell(document_.chosen(), 0);
  is_filling_ = false;
}

void PathPanel::fill_form() {
  is_filling_ = true;
  const DrillPath* path = document_.chosen_path();
  form_->setEnabled(path != nullptr);
  if (path != nullptr) {
    std::size_t bit = 0;
    while (bit < bits_.size() && !(bits_[bit].bit == path->bit)) ++bit;
    bit_->setCurrentIndex(static_cast<int>(bit));
    const bool is_plate = path->bit.is_plate();
    bit_diameter_->setRange(is_plate ? 0.05 : 0.5, is_plate ? 200.0 : 20.0);
    bit_length_->setRange(is_plate ? 0.05 : 5.0, is_plate ? 500.0 : 300.0);
    bit_diameter_->setValue(path->bit.diameter_mm);
    bit_length_->setValue(path->bit.length_mm);
    bit_thickness_->setText(tr("and %1 mm thick").arg(path->bit.thickness_mm, 0, 'f', 2));
    bit_thickness_->setVisible(is_plate);
    int screw = 0;
    if (path->screw) {
      screw = screw_->findText(text_of(path->screw->name));
      if (screw < 0) {  // a plan's own
        screw_->addItem(text_of(path->screw->name));
        screws_.push_back(*path->screw);
        screw = screw_->count() - 1;
      }
    }
    screw_->setCurrentIndex(screw);
    screw_->setEnabled(!path->is_curved());
    screw_->setToolTip(path->is_curved() ? tr("A curved path has no screw: screws are straight.") : QString());
    for (int axis = 0; axis < 3; ++axis) {
      ends_[0][axis]->setValue(path->entry_mm[axis]);
      ends_[1][axis]->setValue(path->target_mm[axis]);
    }
  }
  is_filling_ = false;
}

void PathPanel::rename(int row) {
  if (is_filling_ || row < 0 || row >= static_cast<int>(document_.paths().size())) return;
  DrillPath path = document_.paths()[static_cast<std::size_t>(row)];
  const std::string name = list_->item(row, 0)->text().trimmed().toStdString();
  if (name.empty() || name == path.name) {
    fill_list();
    return;
  }
  path.name = name;
  document_.change_path(row, path, tr("rename path"));
}

void PathPanel::take_bit(int index) {
  const DrillPath* chosen = document_.chosen_path();
  if (chosen == nullptr || index < 0 || index >= static_cast<int>(bits_.size())) return;
  DrillPath path = *chosen;
  path.bit = bits_[static_cast<std::size_t>(index)].bit;
  try {
    document_.change_path(document_.chosen(), path, tr("change bit"));
  } catch (const Error&) {  // too long for a curved path's bends: the old one comes back
    fill_form();
  }
}

void PathPanel::take_bit_size() {
  const DrillPath* chosen = document_.chosen_path();
  if (is_filling_ || chosen == nullptr) return;
  DrillPath path = *chosen;
  try {
    path.bit = resized(path.bit, bit_diameter_->value(), bit_length_->value());
    document_.change_path(document_.chosen(), path, tr("change bit"));
  } catch (const Error&) {  // a tip longer than the bit: the old numbers come back
    fill_form();
  }
}

void PathPanel::take_screw(int index) {
  const DrillPath* chosen = document_.chosen_path();
  if (chosen == nullptr) return;
  DrillPath path = *chosen;
  path.screw = index > 0 ? std::optional(screws_[static_cast<std::size_t>(index - 1)]) : std::nullopt;
  document_.change_path(document_.chosen(), path, tr("change screw"));
}

void PathPanel::take_ends() {
  const DrillPath* chosen = document_.chosen_path();
  if (is_filling_ || chosen == nullptr) return;
  // Boxes show two decimals: a coordinate that they show unchanged keeps all of its own.
  const auto place = [&](int end, const Vec3& own) {
    Vec3 taken = own;
    for (int axis = 0; axis < 3; ++axis) {
      const double shown = ends_[end][axis]->value();
      if (std::abs(shown - own[axis]) > 0.0051) taken[axis] = shown;
    }
    return taken;
  };
  const int index = document_.chosen();
  const Vec3 entry_mm = place(0, chosen->entry_mm), target_mm = place(1, chosen->target_mm);
  bool is_taken = true;
  if (entry_mm != chosen->entry_mm) {
    is_taken = document_.move_end(index, PathEnd::entry, entry_mm);
  } else if (target_mm != chosen->target_mm) {
    is_taken = document_.move_end(index, PathEnd::target, target_mm);
  }
  if (!is_taken) fill_form();
}

}  // namespace spinaltap

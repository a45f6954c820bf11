#include "apps/spinaltap-planner/window/levels_panel.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "apps/report/level_slices.h"
#include "apps/spinaltap-planner/window/words.h"

namespace spinaltap {

LevelsPanel::LevelsPanel(CtLevels& levels, PlanDocument& document, QWidget* parent)
    : QWidget(parent), levels_(levels), document_(document) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(6, 6, 6, 6);
  words_ = new QLabel;
  words_->setObjectName("levelsWords");
  words_->setWordWrap(true);
  words_->setTextFormat(Qt::PlainText);
  words_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  layout->addWidget(words_);

  list_ = new QTableWidget(0, 2);
  list_->setObjectName("levels");
  list_->setAccessibleName(tr("Vertebrae of the CT"));
  list_->setHorizontalHeaderLabels({tr("Vertebra"), tr("State")});
  list_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
  list_->horizontalHeader()->setSectionResizeMode(1, QHeaderView::Stretch);
  list_->verticalHeader()->hide();
  list_->verticalHeader()->setDefaultSectionSize(24);
  list_->setSelectionBehavior(QAbstractItemView::SelectRows);
  list_->setSelectionMode(QAbstractItemView::SingleSelection);
  list_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  list_->setTabKeyNavigation(false);
  layout->addWidget(list_, 1);

  auto* buttons = new QHBoxLayout;
  all_ = new QPushButton(tr("Bake all that are whole"));
  all_->setObjectName("bakeAll");
  find_ = new QPushButton(tr("Look for the vertebrae"));
  find_->setObjectName("findLevels");
  buttons->addWidget(all_);
  buttons->addWidget(find_);
  buttons->addStretch();
  layout->addLayout(buttons);

  connect(list_, &QTableWidget::cellClicked, this, [this](int row) { Q_EMIT wanted(row); });
  // Return; of a double click the second click finds the level at work.
  connect(list_, &QTableWidget::cellActivated, this, [this](int row) { Q_EMIT wanted(row); });
  connect(all_, &QPushButton::clicked, this, &LevelsPanel::all_wanted);
  connect(find_, &QPushButton::clicked, &levels_, &CtLevels::find);
  connect(&levels_, &CtLevels::changed, this, [this] {
    share_ = 0.0;
    fill();
  });
  connect(&levels_.job(), &BackgroundJob::progressed, this, [this](const QString&, double share) {
    share_ = share;
    for (int row = 0; row < list_->rowCount(); ++row) fill_row(row);
  });
  connect(&document_, &PlanDocument::bone_changed, this, &LevelsPanel::fill);
  fill();
}

QString LevelsPanel::words() const {
  QStringList lines;
  switch (levels_.search()) {
    case CtLevels::Search::none:
      if (document_.bone()) {
        lines += tr("This file holds the bone alone. For the vertebrae beside it open its CT.");
      } else {
        lines +=
            tr("Drop the folder of a CT onto the window: its slices are there at once, and its vertebrae are listed "
               "here.");
      }
      break;
    case CtLevels::Search::running:
      lines += tr("Looking for the vertebrae. The slices can be used meanwhile.");
      break;
    case CtLevels::Search::found:
      lines += tr("A click on a vertebra bakes it and shows it in 3D. The slices can be used meanwhile.");
      for (const std::string& gap : levels_.found()->gaps) lines += text_of(gap);
      if (!levels_.found()->transitional.empty()) lines += text_of(levels_.found()->transitional);
      if (std::any_of(levels_.levels().begin(), levels_.levels().end(), [](const CtLevel& level) {
            return !level.is_pointed_at() && level.report.level == Level::kNone;
          })) {
        lines +=
            tr("V1, V2, ... are counted from the head: the CT shows too little to name them. What they may be is "
               "their tool tip.");
      }
      break;
    case CtLevels::Search::failed:
      lines += tr("No vertebra was found: %1.").arg(levels_.why_none());
      lines += tr("Put the crosshair into the middle of a vertebral body and press Ctrl+B.");
      break;
    case CtLevels::Search::cancelled:
      lines +=
          tr("The vertebrae were not looked for to the end. One can be baked all the same: put the crosshair into "
             "its body and press Ctrl+B.");
      break;
  }
  if (levels_.search() != CtLevels::Search::none && document_.opened()) {
    for (const std::string& warning : document_.opened()->ct.warnings) lines += text_of(warning);
  }
  return lines.join("\n\n");
}

QString LevelsPanel::state_of(const CtLevel& level) const {
  switch (level.state) {
    case CtLevel::State::waiting:
      return tr("waits");
    case CtLevel::State::baking:
      return tr("baking, %1 %").arg(static_cast<int>(100.0 * share_));
    case CtLevel::State::baked:
      return level.bone == document_.bone() ? tr("shown") : tr("ready: a click shows it");
    case CtLevel::State::failed:
      return tr("cannot be baked");
    case CtLevel::State::found:
      break;
  }
  if (level.report.is_cut) return tr("not baked; cut by the CT's edge");
  return level.report.is_suspect() ? tr("not baked; to be looked at, it may be wrong") : tr("not baked");
}

void LevelsPanel::fill() {
  words_->setText(words());
  list_->setRowCount(static_cast<int>(levels_.levels().size()));
  for (int row = 0; row < list_->rowCount(); ++row) fill_row(row);
  if (const int shown = levels_.of(document_.bone().get()); shown >= 0) list_->selectRow(shown);
  const bool has_levels = levels_.search() == CtLevels::Search::found;
  all_->setVisible(has_levels);
  all_->setEnabled(std::any_of(levels_.levels().begin(), levels_.levels().end(), [](const CtLevel& level) {
    return level.state == CtLevel::State::found && !level.report.is_cut;
  }));
  find_->setVisible(levels_.search() == CtLevels::Search::cancelled);
}

void LevelsPanel::fill_row(int row) {
  const CtLevel& level = levels_.levels()[static_cast<std::size_t>(row)];
  const QString texts[2] = {level.name(), state_of(level)};
  QStringList tip;
  if (!level.why.isEmpty()) tip += level.why;
  for (const LevelWarning& warning : level.report.warnings) tip += text_of(warning.text);
  if (level.report.level == Level::kNone) {
    for (const LevelProbability& one : level.report.name_probabilities) {
      tip += tr("%1 by %2 %").arg(text_of(level_name(one.level))).arg(100.0 * one.probability, 0, 'f', 0);
    }
  }
  for (int column = 0; column < 2; ++column) {
    QTableWidgetItem* item = list_->item(row, column);
    if (item == nullptr) {
      item = new QTableWidgetItem;
      list_->setItem(row, column, item);
    }
    if (item->text() != texts[column]) item->setText(texts[column]);
    if (const QString words = tip.join("\n"); item->toolTip() != words) item->setToolTip(words);
  }
  const Colour colour = level_colour(static_cast<std::size_t>(row));
  const QColor own = level.is_pointed_at() ? palette().color(QPalette::Text) : QColor(colour[0], colour[1], colour[2]);
  QPixmap square(12, 12);
  square.fill(own);
  list_->item(row, 0)->setData(Qt::DecorationRole, square);
}

}  // namespace spinaltap

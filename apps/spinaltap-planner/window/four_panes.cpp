#include "apps/spinaltap-planner/window/four_panes.h"

#include <QSplitter>
#include <QVBoxLayout>

#include "apps/spinaltap-planner/scene/scene_view.h"
#include "apps/spinaltap-planner/slices/slice_view.h"

namespace spinaltap {

FourPanes::FourPanes(PlanDocument& document, ViewState& state, QWidget* parent) : QWidget(parent) {
  slices_ = {new SliceView(SliceKind::axial, document, state), new SliceView(SliceKind::coronal, document, state),
             new SliceView(SliceKind::sagittal, document, state)};
  scene_ = new SceneView(document, state);
  const std::array<QWidget*, 4> panes{slices_[0], slices_[1], scene_, slices_[2]};
  const std::array<const char*, 4> names{"axial", "coronal", "3d", "sagittal"};
  columns_ = new QSplitter(Qt::Horizontal);
  for (std::size_t column = 0; column < 2; ++column) {
    auto* rows = new QSplitter(Qt::Vertical);
    rows->setChildrenCollapsible(false);
    for (std::size_t row = 0; row < 2; ++row) {
      QWidget* pane = panes[2 * column + row];
      pane->setObjectName(QString::fromLatin1(names[2 * column + row]));
      pane->setMinimumSize(140, 120);
      rows->addWidget(pane);
    }
    rows->setSizes({1000, 1000});
    columns_->addWidget(rows);
  }
  columns_->setChildrenCollapsible(false);
  columns_->setSizes({1000, 1000});
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(columns_);
}

QWidget* FourPanes::pane(const QString& name) const {
  for (SliceView* slice : slices_) {
    if (slice->objectName() == name) return slice;
  }
  return name == "3d" ? scene_ : nullptr;
}

void FourPanes::show_only(const QString& name) {
  for (int column = 0; column < columns_->count(); ++column) {
    auto* rows = qobject_cast<QSplitter*>(columns_->widget(column));
    bool is_any = false;
    for (int row = 0; row < rows->count(); ++row) {
      const bool is_shown = name.isEmpty() || rows->widget(row)->objectName() == name;
      rows->widget(row)->setVisible(is_shown);
      is_any = is_any || is_shown;
    }
    rows->setVisible(is_any);
  }
}

void FourPanes::fit_slices_to(const Box3& shown_mm) {
  for (SliceView* slice : slices_) slice->fit_to(shown_mm);
}

void FourPanes::set_bit(const std::optional<std::pair<DrillBit, Pose>>& bit) {
  for (SliceView* slice : slices_) slice->set_bit(bit);
  scene_->set_bit(bit);
}

void FourPanes::update_surface(std::span<const SurfaceUpdate> updates) {
  for (SliceView* slice : slices_) slice->update_surface(updates);
  scene_->update_surface(updates);
}

}  // namespace spinaltap

#pragma once

#include <QColor>
#include <QString>
#include <optional>
#include <vector>

#include "apps/report/label_place.h"
#include "apps/report/slice_frame.h"
#include "apps/spinaltap-planner/slices/pane_scene.h"
#include "apps/spinaltap-planner/slices/slice_image.h"

class QPainter;

namespace spinaltap {

/// Where the other standard planes through the crosshair cut the slice, in their colours, open around the crosshair.
void paint_crosshair(QPainter& painter, const PaneScene& scene);

/// The patient's directions at the four edges, a scale bar, the plane's words in its colour and the HU window in the
/// corners.
/// `labels` avoids them afterwards.
void paint_pane_words(QPainter& painter, const PaneScene& scene, const QString& caption, const QColor& colour,
                      const HuWindow& window, LabelPlacer& labels);

/// Names of levels beside their bone.
void paint_level_names(QPainter& painter, const PaneScene& scene, const std::vector<SliceName>& names,
                       LabelPlacer& labels);

/// The pane's edge in its colour, stronger where it has the keys.
void paint_pane_edge(QPainter& painter, const QSizeF& size, const QColor& colour, bool has_focus);

/// A pane that has nothing to show says why.
void paint_empty_pane(QPainter& painter, const QSizeF& size, const QString& caption, const QColor& colour,
                      const QString& hint);

}  // namespace spinaltap

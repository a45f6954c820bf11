#include "apps/spinaltap-planner/figures/figures_panel.h"

#include <QComboBox>
#include <QLabel>
#include <QVBoxLayout>
#include <cmath>

#include "apps/report/fixation_report.h"
#include "apps/report/grade_report.h"
#include "apps/report/text.h"
#include "apps/spinaltap-planner/figures/path_figures.h"
#include "apps/spinaltap-planner/plots/plot_view.h"
#include "apps/spinaltap-planner/window/words.h"

namespace spinaltap {
namespace {

// Dark on light, for all kinds of colour vision; words say the same.
constexpr const char* kCaution = "#8a5a00";
QString colour_of(Grade grade) {
  switch (grade) {
    case Grade::A:
      return "#007a5a";
    case Grade::B:
      return "#8a6d00";
    default:
      return "#b3261e";
  }
}

QString sign_of(WarningLevel level) {
  switch (level) {
    case WarningLevel::danger:
      return QStringLiteral("<b style='color:#b3261e'>\u26a0 ");
    case WarningLevel::caution:
      return QStringLiteral("<b style='color:%1'>\u25b2 ").arg(kCaution);
    case WarningLevel::note:
      break;
  }
  return QStringLiteral("<b style='color:#404040'>\u2022 ");
}

QString clearance_text(const Approach& approach) {
  if (!std::isfinite(approach.clearance_mm)) return FiguresPanel::tr("not near");
  return FiguresPanel::tr("%1 mm at %2 mm of depth")
      .arg(approach.clearance_mm, 0, 'f', 2)
      .arg(approach.depth_mm, 0, 'f', 1);
}

QString walls_text(const PathGrade& grade, const std::vector<double>& hu_bands) {
  QString text =
      FiguresPanel::tr("Canal: %1<br>Outer surface: %2").arg(clearance_text(grade.canal), clearance_text(grade.outer));
  if (std::isfinite(grade.hu)) {
    QStringList shares;
    const std::vector<std::string> names = band_names(hu_bands);
    for (std::size_t n = 0; n < names.size() && n < grade.hu_band_shares.size(); ++n) {
      shares += QString("%1 % %2").arg(100.0 * grade.hu_band_shares[n], 0, 'f', 0).arg(text_of(names[n]));
    }
    text += FiguresPanel::tr("<br>Bone: %1 HU; %2").arg(grade.hu, 0, 'f', 0).arg(shares.join(", "));
  }
  text += FiguresPanel::tr("<br>Max thrust, predicted: %1 N").arg(grade.max_thrust_n, 0, 'f', 1);
  text += FiguresPanel::tr("; 5 to 95 % of sources: %1 N").arg(text_of(interval_text(grade.max_thrust_band_n, 1)));
  if (grade.fixation) {
    text += FiguresPanel::tr("<br>Screw: pull-out %1 N, insertion torque up to %2 N·mm (5 to 95 %)")
                .arg(text_of(banded_text(grade.fixation->pullout_n)),
                     text_of(banded_text(grade.fixation->max_torque_n_mm)));
  }
  return text;
}

/// "1.2 mm clear", "1.2 mm deep in bone"; empty where there is no such part near.
QString part_text(const QString& name, double clearance_mm) {
  if (!std::isfinite(clearance_mm)) return {};
  const QString words =
      clearance_mm < 0.0 ? FiguresPanel::tr("%1 %2 mm deep in bone") : FiguresPanel::tr("%1 %2 mm clear of bone");
  return words.arg(name).arg(std::abs(clearance_mm), 0, 'f', 1);
}

/// The other scales, and all that lies behind the entry.
QString instrument_text(const PathGrade& grade) {
  const InstrumentContacts& behind = grade.instrument;
  QStringList parts;
  if (std::isfinite(grade.entry_slant_deg)) {
    parts += FiguresPanel::tr("surface slants by %1\u00b0").arg(grade.entry_slant_deg, 0, 'f', 0);
  }
  parts += behind.cut_behind_mm >= kTouchMm
               ? FiguresPanel::tr("way in cuts %1 mm deep").arg(behind.cut_behind_mm, 0, 'f', 1)
               : FiguresPanel::tr("way in free");
  parts += part_text(FiguresPanel::tr("head"), behind.head_clearance_mm);
  parts += part_text(FiguresPanel::tr("driver"), behind.driver_clearance_mm);
  parts.removeAll(QString());
  return FiguresPanel::tr("<br>Heary %1, Rampersaud %2, facet (Babu) %3<br>At the entry: %4")
      .arg(QString::fromLatin1(name_of(grade.heary)))
      .arg(QChar::fromLatin1(grade.rampersaud))
      .arg(grade.facet)
      .arg(parts.join(", "));
}

QString reasons_text(const PathFigures& figures) {
  if (!figures.technique) return {};
  QString text = FiguresPanel::tr("<b>Suggested, technique: %1</b>").arg(text_of(name_of(*figures.technique)));
  for (const std::string& reason : figures.reasons) {
    text += QStringLiteral("<br>\u2022 ") + text_of(reason).toHtmlEscaped();
  }
  return text;
}

QLabel* wrapped_label(const char* name, QLayout* layout) {
  auto* label = new QLabel;
  label->setObjectName(QString::fromLatin1(name));
  label->setWordWrap(true);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse);
  layout->addWidget(label);
  return label;
}

}  // namespace

FiguresPanel::FiguresPanel(QWidget* parent) : QWidget(parent) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(6, 0, 6, 6);
  layout->setSpacing(4);
  grade_ = wrapped_label("grade", layout);
  walls_ = wrapped_label("walls", layout);
  warnings_ = wrapped_label("warnings", layout);
  reasons_ = wrapped_label("reasons", layout);
  choice_ = new QComboBox;
  choice_->setObjectName("plotChoice");
  choice_->setAccessibleName(tr("What is plotted along the depth"));
  choice_->addItems({tr("Clearance along the depth"), tr("CT number along the depth"), tr("Bone by bands of HU"),
                     tr("Predicted thrust")});
  layout->addWidget(choice_);
  plot_ = new PlotView;
  plot_->setObjectName("pathPlot");
  layout->addWidget(plot_, 1);
  connect(choice_, qOverload<int>(&QComboBox::currentIndexChanged), this, [this] { show_plot(); });
  show_figures(nullptr, {});
}

void FiguresPanel::show_figures(const PathFigures* figures, const std::vector<double>& hu_bands) {
  plots_.clear();
  if (figures == nullptr) {
    grade_->setText(tr("No path chosen"));
    walls_->clear();
    warnings_->clear();
    reasons_->clear();
  } else {
    const PathGrade& grade = figures->graded.grade;
    if (figures->is_graded) {
      // A good grade of a surface that may be wrong is not green.
      QString text = text_of(meaning_of(grade));
      const bool leans_on_doubt = grade.grade <= Grade::B && (!figures->doubt.empty() || !grade.doubts.empty());
      if (leans_on_doubt && !figures->doubt.empty())
        text += tr(", but %1 may be wrong: see below").arg(text_of(figures->doubt));
      grade_->setText(QString("<b style='font-size:large;color:%1'>%2</b>")
                          .arg(leans_on_doubt ? kCaution : colour_of(grade.grade), text.toHtmlEscaped()));
      walls_->setText(walls_text(grade, hu_bands) + instrument_text(grade));
      plots_ = {clearance_plot(figures->graded), hu_plot(figures->graded), bands_plot(figures->graded, hu_bands),
                predicted_thrust_plot(figures->graded)};
      for (Plot& plot : plots_) plot.title.clear();  // the choice says it
    } else {
      grade_->setText(tr("<b>Not graded</b>"));
      walls_->clear();
    }
    QStringList lines;
    for (const PathWarning& warning : figures->warnings) {
      lines += sign_of(warning.level) + text_of(warning.text).toHtmlEscaped() + "</b>";
    }
    warnings_->setText(lines.join("<br>"));
    reasons_->setText(reasons_text(*figures));
  }
  walls_->setVisible(!walls_->text().isEmpty());
  warnings_->setVisible(!warnings_->text().isEmpty());
  reasons_->setVisible(!reasons_->text().isEmpty());
  show_plot();
}

void FiguresPanel::show_plot() {
  const auto index = static_cast<std::size_t>(choice_->currentIndex());
  plot_->set_plot(index < plots_.size() ? plots_[index] : Plot());
}

}  // namespace spinaltap

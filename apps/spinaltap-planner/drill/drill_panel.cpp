#include "apps/spinaltap-planner/drill/drill_panel.h"

#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QGridLayout>
#include <QLabel>
#include <QListWidget>
#include <QToolButton>
#include <QVBoxLayout>
#include <string>
#include <utility>

#include "apps/report/session_report.h"
#include "apps/spinaltap-planner/drill/drill_figures_view.h"
#include "apps/spinaltap-planner/plots/plot_view.h"
#include "apps/spinaltap-planner/window/words.h"

namespace spinaltap {
namespace {

constexpr double kStepBackS = 1.0;

QComboBox* make_choice(const char* name, const QString& told, std::initializer_list<std::pair<QString, QVariant>> all) {
  auto* box = new QComboBox;
  box->setObjectName(QString::fromLatin1(name));
  box->setAccessibleName(told);
  for (const auto& [text, value] : all) box->addItem(text, value);
  return box;
}

QDoubleSpinBox* make_number(const char* name, const QString& told, double min, double max, double step, double value,
                            const QString& unit) {
  auto* box = new QDoubleSpinBox;
  box->setObjectName(QString::fromLatin1(name));
  box->setAccessibleName(told);
  box->setRange(min, max);
  box->setSingleStep(step);
  box->setDecimals(step < 1.0 ? 1 : 0);
  box->setValue(value);
  box->setSuffix(unit);
  return box;
}

QToolButton* make_button(const char* name, QAction* action) {
  auto* button = new QToolButton;
  button->setObjectName(QString::fromLatin1(name));
  button->setDefaultAction(action);
  button->setToolButtonStyle(Qt::ToolButtonTextOnly);
  button->setFocusPolicy(Qt::StrongFocus);
  button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  return button;
}

bool is_warning(EventKind kind) {
  switch (kind) {
    case EventKind::outer_breach:
    case EventKind::canal_breach:
    case EventKind::breakthrough:
    case EventKind::stop_thrust:
    case EventKind::stop_clearance:
    case EventKind::stop_breach:
    case EventKind::plunge:
    case EventKind::heat_limit:
    case EventKind::device_lost:
      return true;
    default:
      return false;
  }
}

QString words_of(const SessionEvent& event) {
  QString text = QStringLiteral("%1 mm  %2")
                     .arg(event.depth_mm, 6, 'f', 2)
                     .arg(QString::fromStdString(std::string(name_of(event.kind))));
  const std::string value = value_text(event);
  return value.empty() ? text : text + QStringLiteral(": ") + QString::fromStdString(value);
}

}  // namespace

DrillPanel::DrillPanel(PlanDocument& document, DrillPlayer& player, QWidget* parent)
    : QWidget(parent), document_(document), player_(player) {
  setObjectName(QStringLiteral("drill_panel"));
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(8, 8, 8, 8);
  column->addWidget(make_choices());
  column->addWidget(make_buttons());
  trouble_ = new QLabel;
  trouble_->setObjectName(QStringLiteral("drill_trouble"));
  trouble_->setWordWrap(true);
  trouble_->setStyleSheet(QStringLiteral("color: #b3261e"));
  trouble_->hide();
  column->addWidget(trouble_);
  figures_ = new DrillFiguresView;
  column->addWidget(figures_);
  curve_ = make_choice("drill_curve", tr("Curve"),
                       {{tr("Thrust along the depth"), static_cast<int>(DrillCurve::thrust)},
                        {tr("Torque along the depth"), static_cast<int>(DrillCurve::torque)},
                        {tr("Density of the removed bone"), static_cast<int>(DrillCurve::density)},
                        {tr("Clearances along the depth"), static_cast<int>(DrillCurve::clearance)},
                        {tr("Temperature of the bone beside the hole"), static_cast<int>(DrillCurve::temperature)}});
  curve_->setToolTip(tr("Which curve is drawn below"));
  column->addWidget(curve_);
  plot_ = new PlotView;
  plot_->setObjectName(QStringLiteral("drill_plot"));
  plot_->set_hint(
      tr("Drill a path to see thrust, torque, density, clearances and the bone's temperature along its depth."));
  column->addWidget(plot_, 3);
  events_ = new QListWidget;
  events_->setObjectName(QStringLiteral("drill_events"));
  events_->setAccessibleName(tr("What happened"));
  events_->setToolTip(tr("What happened, with the depth of the tip; warnings in red"));
  events_->setMinimumHeight(70);
  column->addWidget(events_, 1);

  connect(curve_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &DrillPanel::show_plot);
  connect(&player_, &DrillPlayer::started, this, &DrillPanel::show_plan);
  connect(&player_, &DrillPlayer::state_changed, this, &DrillPanel::show_progress);
  connect(&player_, &DrillPlayer::progressed, this, &DrillPanel::show_progress);
  connect(&player_, &DrillPlayer::failed, this, [this](const QString& why) {
    trouble_->setText(why);
    trouble_->show();
  });
  connect(&document_, &PlanDocument::chosen_changed, this, &DrillPanel::enable);
  connect(&document_, &PlanDocument::paths_changed, this, &DrillPanel::enable);
  connect(&document_, &PlanDocument::bone_changed, this, &DrillPanel::enable);
  show_progress();
}

QWidget* DrillPanel::make_choices() {
  operator_ = make_choice("drill_operator", tr("Operator"),
                          {{tr("steady, on the path"), QStringLiteral("on-path")},
                           {tr("steady, 1.2 mm beside the path"), QStringLiteral("off-path")},
                           {tr("steady, tilted by 3°"), QStringLiteral("tilted")},
                           {tr("trembling by 0.1 mm"), QStringLiteral("tremor")},
                           {tr("pushing with a force"), QStringLiteral("push")},
                           {tr("milling, as a file says"), QStringLiteral("milling")}});
  operator_->setToolTip(tr("Who moves the drill"));
  choose_milling_ = make_action("drill_choose_milling", tr("Choose a file…"),
                                tr("What a burr, the bit of the chosen path, is to mill away: a milling's file"),
                                tr("Ctrl+Alt+M"), [this] { Q_EMIT milling_wanted(); });
  auto* milling = make_button("drill_choose_milling", choose_milling_);
  milling->setAccessibleName(tr("Milling"));
  engine_ = make_choice("drill_engine", tr("Engine"),
                        {{tr("automatic"), static_cast<int>(EngineKind::automatic)},
                         {tr("ring: points around the path"), static_cast<int>(EngineKind::ring)},
                         {tr("leaf: the same, for tilts and burrs"), static_cast<int>(EngineKind::leaf)},
                         {tr("voxel: the whole bone"), static_cast<int>(EngineKind::voxel)}});
  engine_->setToolTip(
      tr("What removes the bone; automatic: voxel for a milling, else ring or leaf, whichever is faster"));
  feed_ = make_number("drill_feed_wanted", tr("Feed"), 0.1, 20.0, 0.1, 1.0, tr(" mm/s"));
  feed_->setToolTip(tr("How fast the operator advances"));
  push_ = make_number("drill_push", tr("Push"), 1.0, 500.0, 1.0, 40.0, tr(" N"));
  push_->setToolTip(tr("With what force the operator pushes; how fast the drill advances follows from the bone"));
  speed_ = make_choice("drill_speed", tr("Speed"),
                       {{tr("0.25 × real time"), 0.25},
                        {tr("0.5 × real time"), 0.5},
                        {tr("real time"), 1.0},
                        {tr("2 × real time"), 2.0},
                        {tr("4 × real time"), 4.0},
                        {tr("as fast as it goes"), 0.0}});
  speed_->setCurrentIndex(2);
  speed_->setToolTip(tr("Pace of the clock, also while drilling; the result is the same at any pace"));
  stops_ = new QCheckBox(tr("Stop at a breach of a wall"));
  stops_->setObjectName(QStringLiteral("drill_stop_on_breach"));
  stops_->setToolTip(tr("The operator stops where the drill breaks through the outer surface or into the canal"));
  make_sound();
  connect(operator_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &DrillPanel::enable);
  connect(speed_, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
          [this] { player_.set_speed(plan().speed); });

  auto* choices = new QWidget;
  auto* form = new QFormLayout(choices);
  form->setContentsMargins(0, 0, 0, 0);
  form->setVerticalSpacing(4);
  form->addRow(tr("&Operator"), operator_);
  form->addRow(tr("&Milling"), milling);
  form->addRow(tr("Fee&d"), feed_);
  form->addRow(tr("P&ush"), push_);
  form->addRow(tr("En&gine"), engine_);
  form->addRow(tr("&Speed"), speed_);
  form->addRow(QString(), stops_);
  form->addRow(QString(), sound_);
  form->addRow(silence_);
  return choices;
}

void DrillPanel::make_sound() {
  sound_ = new QCheckBox(tr("Sound of the drill"));
  sound_->setObjectName(QStringLiteral("drill_sound"));
  sound_->setToolTip(tr("Let the drill be heard while it drills: turning, load, and how dense the bone ahead is"));
  silence_ = new QLabel;
  silence_->setObjectName(QStringLiteral("drill_silence"));
  silence_->setWordWrap(true);
  silence_->hide();
  connect(sound_, &QCheckBox::toggled, &sound_output_, &SoundOutput::set_on);
  connect(&sound_output_, &SoundOutput::told, this, [this](const QString& why_silent) {
    silence_->setText(why_silent.isEmpty() ? QString() : tr("Nothing is heard: %1").arg(why_silent));
    silence_->setHidden(why_silent.isEmpty());
  });
}

void DrillPanel::let_hear() {
  const SessionSetup* setup = player_.setup();
  if (player_.state() == DrillPlayer::State::drilling && setup != nullptr && player_.last()) {
    sound_output_.hear(*setup, *player_.last());
  } else {
    sound_output_.rest();
  }
}

QAction* DrillPanel::make_action(const char* name, const QString& text, const QString& tip, const QKeySequence& key,
                                 const std::function<void()>& work) {
  auto* action = new QAction(text, this);
  action->setObjectName(QString::fromLatin1(name) + "_action");
  action->setShortcut(key);
  action->setToolTip(QStringLiteral("%1 (%2)").arg(tip, key.toString(QKeySequence::NativeText)));
  connect(action, &QAction::triggered, this, work);
  return action;
}

QWidget* DrillPanel::make_buttons() {
  drill_ = make_action("drill_start", tr("Drill"), tr("Drill a new hole along the chosen path"), tr("F6"), [this] {
    trouble_->hide();
    player_.start(plan());
  });
  go_on_ = make_action("drill_go_on", tr("Stop"), tr("Stop where the drill is, or go on from there"), tr("F7"), [this] {
    trouble_->hide();
    if (player_.can_go_on()) {
      player_.go_on();
    } else {
      player_.stop();
    }
  });
  back_ = make_action("drill_back", tr("Back 1 s"), tr("Bone and drill as they were a second ago"), tr("F8"),
                      [this] { player_.step_back(kStepBackS); });
  undo_ = make_action("drill_undo_hole", tr("Undo hole"), tr("Put the bone of the last hole back"), tr("F9"),
                      [this] { player_.undo_hole(); });
  redo_ = make_action("drill_redo_hole", tr("Redo hole"), tr("Take the bone of the undone hole away again"),
                      tr("Shift+F9"), [this] { player_.redo_hole(); });
  record_ =
      make_action("drill_save_record", tr("Save record…"), tr("Save every cycle of the hole, for `spinaltap replay`"),
                  tr("Ctrl+Alt+S"), [this] { Q_EMIT save_record_wanted(); });
  report_ = make_action("drill_write_report", tr("Write report…"),
                        tr("Write a report, the drilled bone and its tables into a folder"), tr("Ctrl+Alt+R"),
                        [this] { Q_EMIT write_report_wanted(); });

  auto* buttons = new QWidget;
  auto* grid = new QGridLayout(buttons);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setSpacing(4);
  const auto add = [grid](const char* name, QAction* action, int row, int column, int columns) {
    grid->addWidget(make_button(name, action), row, column, 1, columns);
  };
  add("drill_start", drill_, 0, 0, 2);
  add("drill_go_on", go_on_, 0, 2, 2);
  add("drill_back", back_, 0, 4, 2);
  add("drill_undo_hole", undo_, 1, 0, 3);
  add("drill_redo_hole", redo_, 1, 3, 3);
  add("drill_save_record", record_, 2, 0, 3);
  add("drill_write_report", report_, 2, 3, 3);
  return buttons;
}

DrillPlan DrillPanel::plan() const {
  DrillPlan plan;
  plan.tool_operator = operator_->currentData().toString().toStdString();
  plan.feed_mm_s = feed_->value();
  plan.push_n = push_->value();
  plan.stops_on_breach = stops_->isChecked();
  plan.speed = speed_->currentData().toDouble();
  plan.engine = static_cast<EngineKind>(engine_->currentData().toInt());
  if (plan.tool_operator == "milling") plan.milling = milling_;
  return plan;
}

void DrillPanel::set_milling(const Milling& milling) {
  milling_ = std::make_shared<const Milling>(milling);
  choose_milling_->setText(milling.name.empty() ? tr("without a name") : text_of(milling.name));
  operator_->setCurrentIndex(operator_->findData(QStringLiteral("milling")));
}

/// What is drilled, whoever asked for it.
void DrillPanel::show_plan() {
  const DrillPlan plan = player_.plan();
  if (plan.source) return;  // the page of the navigation picture shows it
  if (plan.milling) set_milling(*plan.milling);
  operator_->setCurrentIndex(operator_->findData(QString::fromStdString(plan.tool_operator)));
  if (const int engine = engine_->findData(static_cast<int>(plan.engine)); engine >= 0)
    engine_->setCurrentIndex(engine);
  feed_->setValue(plan.feed_mm_s);
  push_->setValue(plan.push_n);
  stops_->setChecked(plan.stops_on_breach);
  if (const int speed = speed_->findData(plan.speed); speed >= 0) speed_->setCurrentIndex(speed);
}

void DrillPanel::enable() {
  using State = DrillPlayer::State;
  const bool is_push = operator_->currentData().toString() == QLatin1String("push");
  const bool is_milling = operator_->currentData().toString() == QLatin1String("milling");
  feed_->setEnabled(!is_push && !is_milling);
  stops_->setEnabled(!is_milling);
  push_->setEnabled(is_push);
  const State state = player_.state();
  const bool is_busy = state == State::drilling || state == State::preparing;
  drill_->setEnabled(!is_busy && document_.bone() && document_.chosen_path() != nullptr);
  go_on_->setEnabled(is_busy || player_.can_go_on());
  go_on_->setText(player_.can_go_on() ? tr("Go on") : tr("Stop"));
  back_->setEnabled(player_.can_step_back());
  undo_->setEnabled(player_.can_undo_hole());
  redo_->setEnabled(player_.can_redo_hole());
  const bool stands = state == State::stopped && player_.last().has_value();
  record_->setEnabled(stands);
  report_->setEnabled(stands);
}

void DrillPanel::show_progress() {
  let_hear();
  enable();
  figures_->show_figures(player_);
  show_plot();
  show_events();
}

void DrillPanel::show_plot() {
  const auto curve = static_cast<DrillCurve>(curve_->currentData().toInt());
  const DrillPath* path = player_.path();
  plot_->set_plot(drill_plot(curve, player_.rows(), path == nullptr ? 1.0 : path->length_mm()));
}

void DrillPanel::show_events() {
  const std::vector<SessionEvent>& events = player_.events();
  // Of events under way the values grow; of all others nothing changes.
  while (static_cast<std::size_t>(events_->count()) > events.size()) delete events_->takeItem(events_->count() - 1);
  for (std::size_t n = 0; n < events.size(); ++n) {
    const int row = static_cast<int>(n);
    if (row == events_->count()) events_->addItem(QString());
    QListWidgetItem* item = events_->item(row);
    const QString words = words_of(events[n]);
    if (item->text() == words) continue;
    item->setText(words);
    item->setForeground(is_warning(events[n].kind) ? QBrush(QColor(0xb3, 0x26, 0x1e)) : QBrush());
    events_->scrollToItem(item);
  }
}

}  // namespace spinaltap

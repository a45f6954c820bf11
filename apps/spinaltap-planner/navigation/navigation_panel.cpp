#include "apps/spinaltap-planner/navigation/navigation_panel.h"

#include <QCheckBox>
#include <QComboBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/spinaltap-planner/navigation/device_source.h"
#include "apps/spinaltap-planner/navigation/link_source.h"
#include "apps/spinaltap-planner/navigation/record_source.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

constexpr double kBarN = 100.0;    // of the thrust that the bar shows whole
constexpr double kStrongN = 60.0;  // above what most drilling in vertebrae takes
constexpr double kTooStrongN = 85.0;

void show_alarm(QLabel* label, const QString& text, Alarm alarm) {
  label->setText(text);
  label->setStyleSheet(QStringLiteral("color: %1").arg(alarm_colour(alarm).name()));
}

}  // namespace

NavigationPanel::NavigationPanel(PlanDocument& document, ViewState& view, DrillPlayer& player, QWidget* parent)
    : QWidget(parent), document_(document), view_(view), player_(player) {
  setObjectName(QStringLiteral("navigation_panel"));
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(8, 8, 8, 8);
  column->addWidget(make_choices());
  bulls_eye_ = new BullsEyeView(document, view);
  bulls_eye_->setObjectName(QStringLiteral("bulls_eye"));
  column->addWidget(bulls_eye_, 1);
  column->addWidget(make_figures());
  connect(&player_, &DrillPlayer::started, this, [this] {
    const auto hand = std::dynamic_pointer_cast<DesktopSource>(player_.plan().source);
    bulls_eye_->set_device(hand ? std::shared_ptr<DesktopDevice>(hand, &hand->device()) : nullptr);
  });
  connect(&player_, &DrillPlayer::state_changed, this, &NavigationPanel::show_progress);
  connect(&player_, &DrillPlayer::progressed, this, &NavigationPanel::show_progress);
  for (const auto changed :
       {&PlanDocument::chosen_changed, &PlanDocument::paths_changed, &PlanDocument::bone_changed}) {
    connect(&document_, changed, this, &NavigationPanel::enable);
  }
  choose_source();
  show_progress();
}

QWidget* NavigationPanel::make_choices() {
  source_ = new QComboBox;
  source_->setObjectName(QStringLiteral("nav_source"));
  source_->setAccessibleName(tr("Who moves the tool"));
  source_->setToolTip(tr("Who moves the tool"));
  source_->addItem(tr("Keyboard and mouse"), QStringLiteral("hand"));
  source_->addItem(tr("Device: a plug-in"), QStringLiteral("device"));
  source_->addItem(tr("OpenIGTLink: listen"), QStringLiteral("listen"));
  source_->addItem(tr("OpenIGTLink: connect"), QStringLiteral("connect"));
  source_->addItem(tr("A record"), QStringLiteral("record"));
  start_ = new QPushButton(tr("Start"));
  start_->setObjectName(QStringLiteral("nav_start"));
  address_ = new QLineEdit;
  address_->setObjectName(QStringLiteral("nav_address"));
  address_->setAccessibleName(tr("Where it is"));
  follows_ = new QCheckBox(tr("Slices follow the tip"));
  follows_->setObjectName(QStringLiteral("nav_follow"));
  follows_->setChecked(true);
  connect(source_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &NavigationPanel::choose_source);
  connect(start_, &QPushButton::clicked, this, &NavigationPanel::press_start);
  auto* choices = new QWidget;
  auto* grid = new QGridLayout(choices);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setSpacing(4);
  grid->addWidget(source_, 0, 0);
  grid->addWidget(start_, 0, 1);
  grid->addWidget(address_, 1, 0);
  grid->addWidget(follows_, 1, 1);
  grid->setColumnStretch(0, 1);
  return choices;
}

QWidget* NavigationPanel::make_figures() {
  figures_ = new QWidget;
  figures_->setObjectName(QStringLiteral("nav_figures"));
  figures_->setAttribute(Qt::WA_StyledBackground);
  figures_->setStyleSheet(QStringLiteral("#nav_figures { background: #15181b; } QLabel { color: #c3cad0; }"));
  auto* grid = new QGridLayout(figures_);
  grid->setContentsMargins(10, 6, 10, 8);
  grid->setHorizontalSpacing(12);
  grid->setVerticalSpacing(0);
  entry_ = add_figure("nav_entry", tr("Off the entry"), 0, 0);
  target_ = add_figure("nav_target", tr("Heads past target by"), 0, 1);
  tip_ = add_figure("nav_tip", tr("Tip off the path"), 1, 0);
  angle_ = add_figure("nav_angle", tr("Angle to the path"), 1, 1);
  outer_ = add_figure("nav_outer", tr("To outer wall"), 2, 0);
  canal_ = add_figure("nav_canal", tr("To canal"), 2, 1);
  left_ = add_figure("nav_left", tr("Depth left"), 3, 0);
  hand_ = add_figure("nav_hand", tr("Force at the hand"), 3, 1);
  entry_->setToolTip(tr("How far the bit's axis is from the plan's entry, across the path"));
  target_->setToolTip(tr("How far the bit's axis would miss the plan's target, if it went on as it points"));
  force_ = new QProgressBar;
  force_->setObjectName(QStringLiteral("nav_force"));
  force_->setAccessibleName(tr("Thrust"));
  force_->setRange(0, 1000);
  force_->setTextVisible(true);
  grid->addWidget(force_, 8, 0, 1, 2);
  state_ = new QLabel;
  state_->setObjectName(QStringLiteral("nav_state"));
  state_->setMinimumHeight(24);
  grid->addWidget(state_, 9, 0, 1, 2);
  grid->setColumnStretch(0, 1);
  grid->setColumnStretch(1, 1);
  return figures_;
}

QLabel* NavigationPanel::add_figure(const char* name, const QString& title, int row, int column) {
  auto* grid = static_cast<QGridLayout*>(figures_->layout());
  auto* words = new QLabel(title);
  grid->addWidget(words, 2 * row, column);
  auto* value = new QLabel(QStringLiteral("–"));
  value->setObjectName(QString::fromLatin1(name));
  value->setAccessibleName(title);
  QFont font = value->font();
  font.setPointSizeF(17.0);
  font.setBold(true);
  value->setFont(font);
  grid->addWidget(value, 2 * row + 1, column);
  return value;
}

void NavigationPanel::choose_source() {
  const QString source = source_->currentData().toString();
  const std::map<QString, std::pair<QString, QString>> addresses{
      {"device", {"loopback", tr("FILE.so[:SETTINGS], or loopback")}},
      {"listen", {"18944", tr("The port to listen at")}},
      {"connect", {"localhost:18944", tr("HOST:PORT of the server")}},
      {"record", {"", tr("FILE.h5 that was drilled in this bone")}}};
  const auto found = addresses.find(source);
  address_->setEnabled(found != addresses.end());
  address_->setText(found == addresses.end() ? QString() : found->second.first);
  address_->setPlaceholderText(found == addresses.end() ? tr("mouse and keys in the view") : found->second.second);
  address_->setToolTip(address_->placeholderText());
}

std::shared_ptr<NavigationSource> NavigationPanel::make_source(const QString& source, const QString& address) const {
  const std::string where = address.toStdString();
  if (source == "hand") return std::make_shared<DesktopSource>();
  if (source == "device") return std::make_shared<DeviceSource>(where);
  if (source == "listen") return listening_link(where);
  if (source == "connect") return connecting_link(where);
  if (source != "record")
    fail("expected hand, device, listen, connect or record, found \"", source.toStdString(), "\"");
  if (!document_.bone()) fail("expected the bone that was drilled, found none: open it first");
  return open_record(where, *document_.bone()->bone);
}

void NavigationPanel::start(const QString& source, const QString& address) {
  DrillPlan plan;
  plan.source = make_source(source, address);
  plan.tool_operator = "navigation";
  player_.start(plan);
  if (source_->currentData().toString() != source) source_->setCurrentIndex(source_->findData(source));
  address_->setText(address);
  if (source == "hand") bulls_eye_->setFocus();
}

void NavigationPanel::press_start() {
  using State = DrillPlayer::State;
  if (player_.state() == State::drilling || player_.state() == State::preparing) {
    player_.stop();
    return;
  }
  try {
    start(source_->currentData().toString(), address_->text());
  } catch (const std::exception& error) {
    Q_EMIT failed(QString::fromUtf8(error.what()));
  }
}

void NavigationPanel::enable() {
  using State = DrillPlayer::State;
  const bool is_busy = player_.state() == State::drilling || player_.state() == State::preparing;
  start_->setText(is_busy ? tr("Stop") : tr("Start"));
  start_->setEnabled(is_busy || (document_.bone() && document_.chosen_path() != nullptr));
  source_->setEnabled(!is_busy);
  address_->setReadOnly(is_busy);
}

void NavigationPanel::show_progress() {
  enable();
  const DrillPath* path = player_.path();
  std::optional<NavigationFigures> figures;
  if (path != nullptr && player_.last()) figures = navigation_figures(PathCurve(*path), *player_.last());
  bulls_eye_->show_tool(figures, path != nullptr ? std::optional(*path) : std::nullopt);
  const NavigationFigures none;
  const NavigationFigures& shown = figures ? *figures : none;
  const auto show = [&](QLabel* label, const QString& text, Alarm alarm) {
    show_alarm(label, figures ? text : QStringLiteral("–"), figures ? alarm : Alarm::none);
  };
  show(entry_, mm_words(shown.entry_off_mm), shown.entry);
  show(target_, mm_words(shown.target_off_mm), shown.target);
  show(tip_, mm_words(shown.tip_off_mm), shown.tip);
  show(angle_, degree_words(shown.plan.angle_deg), shown.angle);
  show(left_, left_words(shown.plan.left_mm), shown.left);
  show(outer_, wall_words(shown.outer_mm), shown.outer);
  show(canal_, wall_words(shown.canal_mm), shown.canal);
  show(hand_, tr("%1 N").arg(shown.hand_n, 0, 'f', 1), Alarm::none);
  force_->setValue(static_cast<int>(std::lround(1000.0 * std::clamp(shown.thrust_n / kBarN, 0.0, 1.0))));
  force_->setFormat(figures ? tr("cutting thrust %1 N").arg(shown.thrust_n, 0, 'f', 0) : tr("cutting thrust –"));
  const Alarm strength = shown.thrust_n > kTooStrongN ? Alarm::bad
                         : shown.thrust_n > kStrongN  ? Alarm::near
                                                      : Alarm::none;
  force_->setStyleSheet(QStringLiteral("QProgressBar { background: #2a2f34; color: white; border: 1px solid #4a525a; "
                                       "text-align: center; font-weight: 600; } "
                                       "QProgressBar::chunk { background: %1; }")
                            .arg(alarm_colour(strength).darker(190).name()));
  show_state(figures);
  if (figures && player_.plan().source && follows_->isChecked() && player_.state() == DrillPlayer::State::drilling) {
    view_.set_crosshair(figures->pose.tip_mm);
  }
}

void NavigationPanel::show_state(const std::optional<NavigationFigures>& figures) {
  using State = DrillPlayer::State;
  const auto& source = player_.plan().source;
  const QString who = source ? text_of(source->name()) : tr("planned motion");
  QString words = tr("No tool");
  Alarm alarm = Alarm::none;
  if (player_.state() == State::preparing) {
    words = tr("Preparing: %1").arg(who);
  } else if (figures && figures->is_lost) {
    words = tr("TOOL NOT SEEN: %1; spindle off").arg(who);
    alarm = Alarm::bad;
  } else if (figures && player_.state() == State::stopped) {
    words = tr("Stopped: %1, at %2 s").arg(who).arg(player_.seconds(), 0, 'f', 1);
    alarm = Alarm::near;
  } else if (figures) {
    words = tr("%1, %2 s, spindle %3")
                .arg(who)
                .arg(player_.seconds(), 0, 'f', 1)
                .arg(figures->spindle_on ? tr("ON") : tr("off"));
  }
  show_alarm(state_, words, alarm);
}

}  // namespace spinaltap

#include "apps/spinaltap-planner/sound/sound_output.h"

#include <QMetaObject>

#include "apps/spinaltap-planner/sound/sound_player.h"
#include "core/sound/session_sound.h"

namespace spinaltap {

SoundOutput::SoundOutput(QObject* parent) : QObject(parent), player_(new SoundPlayer) {
  player_->moveToThread(&thread_);
  connect(&thread_, &QThread::finished, player_, &QObject::deleteLater);
  connect(player_, &SoundPlayer::told, this, [this](const QString& why_silent) {
    if (is_on_) Q_EMIT told(why_silent);  // what comes late, after it was turned off, is nobody's
  });
  thread_.setObjectName(QStringLiteral("sound"));
}

SoundOutput::~SoundOutput() {
  if (!thread_.isRunning()) {
    delete player_;
    return;
  }
  thread_.quit();
  thread_.wait();
}

void SoundOutput::set_on(bool is_on) {
  if (is_on == is_on_) return;
  is_on_ = is_on;
  if (is_on) {
    play(options_);
    return;
  }
  QMetaObject::invokeMethod(
      player_, [player = player_] { player->stop(); }, Qt::QueuedConnection);
  Q_EMIT told(QString());
}

void SoundOutput::play(const DrillSoundOptions& options) {
  options_ = options;
  if (!thread_.isRunning()) thread_.start(QThread::HighPriority);
  QMetaObject::invokeMethod(
      player_, [player = player_, options, input = input_] { player->play(options, input); }, Qt::QueuedConnection);
}

void SoundOutput::hear(const SessionSetup& setup, const Cycle& cycle) {
  if (!is_on_) return;
  const DrillSoundOptions options = sound_options(setup, SessionSound::without_edges());
  const bool is_same = options.edges == options_.edges && options.droop_per_n_mm == options_.droop_per_n_mm &&
                       options.spin_up_s == options_.spin_up_s;
  if (!is_same) play(options);  // another tool, or another motor
  input_->set(sound_input(cycle, setup.options.spindle.rpm));
}

void SoundOutput::rest() { input_->set({}); }

}  // namespace spinaltap

#pragma once

#include <QObject>
#include <QThread>
#include <memory>

#include "apps/spinaltap-planner/sound/sound_stream.h"
#include "core/session/drill_session.h"
#include "core/session/session_setup.h"

namespace spinaltap {

class SoundPlayer;

/// Lets a drilling be heard by the computer's audio device while it goes on: docs/sound.md. Off to begin with. The
/// device is looked for, opened and fed on a thread of its own, so that neither window nor drilling waits for it.
class SoundOutput : public QObject {
  Q_OBJECT
 public:
  explicit SoundOutput(QObject* parent = nullptr);
  ~SoundOutput() override;

  void set_on(bool is_on);
  bool is_on() const { return is_on_; }
  /// The drill as it now is.
  void hear(const SessionSetup& setup, const Cycle& cycle);
  /// The motor is off, and runs down.
  void rest();

 Q_SIGNALS:
  /// Why nothing is heard, in words; empty where the device plays.
  void told(const QString& why_silent);

 private:
  void play(const DrillSoundOptions& options);

  bool is_on_ = false;
  DrillSoundOptions options_;
  std::shared_ptr<LiveInput> input_ = std::make_shared<LiveInput>();
  QThread thread_;
  SoundPlayer* player_ = nullptr;  ///< the thread's
};

}  // namespace spinaltap

#pragma once

#include <QObject>
#include <memory>

#include "apps/spinaltap-planner/sound/sound_stream.h"

class QAudioOutput;

namespace spinaltap {

/// Opens the computer's audio device and lets it read a stream. All of it, also its end, is on one thread, which may
/// wait for a device.
class SoundPlayer : public QObject {
  Q_OBJECT
 public:
  SoundPlayer();
  ~SoundPlayer() override;

  void play(const DrillSoundOptions& options, const std::shared_ptr<LiveInput>& input);
  void stop();

 Q_SIGNALS:
  void told(const QString& why_silent);

 private:
  std::unique_ptr<SoundStream> stream_;
  std::unique_ptr<QAudioOutput> output_;
};

}  // namespace spinaltap

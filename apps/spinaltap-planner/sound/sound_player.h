#pragma once

#include <QObject>
#include <memory>

#include "apps/spinaltap-planner/sound/sound_stream.h"

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
  struct Output;  ///< Qt's, which Qt 5 and 6 name differently

  std::unique_ptr<SoundStream> stream_;
  std::unique_ptr<Output> output_;
};

}  // namespace spinaltap

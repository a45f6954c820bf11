#pragma once

#include <QIODevice>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "core/sound/drill_sound.h"

namespace spinaltap {

/// What is to be heard, from the thread that knows it to the one that renders it. The latest counts; neither waits for
/// more than a copy.
class LiveInput {
 public:
  void set(const DrillSoundInput& input);
  /// Whether there is a new one that can be had at once.
  bool take(DrillSoundInput& input);

 private:
  std::mutex mutex_;
  DrillSoundInput input_;
  bool is_new_ = false;
};

/// The drill's sound as an audio device reads it: mono samples of 16 bits, the machine's order of bytes, as many as it
/// asks for and without end. What LiveInput holds when it asks is heard from its first sample on.
class SoundStream : public QIODevice {
 public:
  /// Throws Error as DrillSound does.
  SoundStream(const DrillSoundOptions& options, std::shared_ptr<LiveInput> input);

  bool isSequential() const override { return true; }
  qint64 bytesAvailable() const override;

  static std::int16_t to_16_bits(float sample);

 protected:
  /// Whole samples only.
  qint64 readData(char* data, qint64 bytes) override;
  qint64 writeData(const char* data, qint64 bytes) override;

 private:
  DrillSound drill_;
  std::shared_ptr<LiveInput> input_;
  std::vector<float> samples_;
};

}  // namespace spinaltap

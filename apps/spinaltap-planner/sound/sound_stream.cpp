#include "apps/spinaltap-planner/sound/sound_stream.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr qint64 kBytesASample = sizeof(std::int16_t);
constexpr qint64 kMostBytes = 65536;  ///< at a time: a device asks for far less

}  // namespace

void LiveInput::set(const DrillSoundInput& input) {
  const std::lock_guard lock(mutex_);
  input_ = input;
  is_new_ = true;
}

bool LiveInput::take(DrillSoundInput& input) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock() || !is_new_) return false;
  input = input_;
  is_new_ = false;
  return true;
}

SoundStream::SoundStream(const DrillSoundOptions& options, std::shared_ptr<LiveInput> input)
    : drill_(options), input_(std::move(input)) {
  samples_.reserve(kMostBytes / kBytesASample);
  open(QIODevice::ReadOnly | QIODevice::Unbuffered);
}

qint64 SoundStream::bytesAvailable() const { return kMostBytes; }

std::int16_t SoundStream::to_16_bits(float sample) {
  constexpr float kFullScale = 32767.0F;
  return static_cast<std::int16_t>(std::lround(kFullScale * std::clamp(sample, -1.0F, 1.0F)));
}

qint64 SoundStream::readData(char* data, qint64 bytes) {
  DrillSoundInput input;
  if (input_->take(input)) {
    try {
      drill_.set(input);
    } catch (const Error&) {  // no number, or beyond all drills: the sound goes on as before
    }
  }
  samples_.resize(static_cast<std::size_t>(std::min(bytes, kMostBytes) / kBytesASample));
  drill_.render(samples_);
  for (std::size_t n = 0; n < samples_.size(); ++n) {
    const std::int16_t sample = to_16_bits(samples_[n]);
    std::memcpy(data + n * sizeof sample, &sample, sizeof sample);
  }
  return static_cast<qint64>(samples_.size()) * kBytesASample;
}

qint64 SoundStream::writeData(const char*, qint64) { return -1; }

}  // namespace spinaltap

#include "apps/spinaltap-planner/sound/sound_player.h"

#ifdef SPINALTAP_QT_MULTIMEDIA
#include <QAudioDeviceInfo>
#include <QAudioFormat>
#include <QAudioOutput>
#else
class QAudioOutput {};
#endif

namespace spinaltap {

SoundPlayer::SoundPlayer() = default;
SoundPlayer::~SoundPlayer() = default;

void SoundPlayer::stop() {
  output_.reset();  // before what it reads
  stream_.reset();
}

#ifdef SPINALTAP_QT_MULTIMEDIA

void SoundPlayer::play(const DrillSoundOptions& options, const std::shared_ptr<LiveInput>& input) {
  /// Held by the device: as late as a sound comes at most, and as long as this thread may be held up.
  constexpr double kBufferS = 0.06;
  stop();
  const QAudioDeviceInfo device = QAudioDeviceInfo::defaultOutputDevice();
  if (device.isNull()) {
    Q_EMIT told(tr("this computer has no audio device"));
    return;
  }
  QAudioFormat format;
  format.setCodec(QStringLiteral("audio/pcm"));
  format.setSampleRate(static_cast<int>(options.sample_rate_hz));
  format.setChannelCount(1);
  format.setSampleSize(16);
  format.setSampleType(QAudioFormat::SignedInt);
  format.setByteOrder(Q_BYTE_ORDER == Q_BIG_ENDIAN ? QAudioFormat::BigEndian : QAudioFormat::LittleEndian);
  if (!device.isFormatSupported(format)) {
    Q_EMIT told(tr("the audio device %1 takes no single channel of 16 bits at %2 Hz")
                    .arg(device.deviceName())
                    .arg(format.sampleRate()));
    return;
  }
  stream_ = std::make_unique<SoundStream>(options, input);
  output_ = std::make_unique<QAudioOutput>(device, format);
  output_->setBufferSize(format.bytesForDuration(static_cast<qint64>(1e6 * kBufferS)));
  connect(output_.get(), &QAudioOutput::stateChanged, this, [this](QAudio::State state) {
    const bool has_failed = state == QAudio::StoppedState && output_ && output_->error() != QAudio::NoError;
    if (has_failed) Q_EMIT told(tr("the audio device has stopped"));
  });
  output_->start(stream_.get());
  if (output_->error() != QAudio::NoError) {
    Q_EMIT told(tr("the audio device %1 cannot be opened").arg(device.deviceName()));
    return;
  }
  Q_EMIT told(QString());
}

#else

void SoundPlayer::play(const DrillSoundOptions&, const std::shared_ptr<LiveInput>&) {
  Q_EMIT told(tr("this program was built without Qt Multimedia"));
}

#endif

}  // namespace spinaltap

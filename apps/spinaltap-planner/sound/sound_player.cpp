#include "apps/spinaltap-planner/sound/sound_player.h"

#include <QtGlobal>

#ifdef SPINALTAP_QT_MULTIMEDIA
#include <QAudioFormat>
#if QT_VERSION >= QT_VERSION_CHECK(6, 0, 0)
#include <QAudioDevice>
#include <QAudioSink>
#include <QMediaDevices>
#else
#include <QAudioDeviceInfo>
#include <QAudioOutput>
#endif
#endif

namespace spinaltap {
namespace {

#if !defined(SPINALTAP_QT_MULTIMEDIA)

struct Sink {};

#elif QT_VERSION >= QT_VERSION_CHECK(6, 0, 0)

using Sink = QAudioSink;
using Device = QAudioDevice;

Device default_device() { return QMediaDevices::defaultAudioOutput(); }
QString name_of(const Device& device) { return device.description(); }
void set_samples(QAudioFormat& format) { format.setSampleFormat(QAudioFormat::Int16); }

#else

using Sink = QAudioOutput;
using Device = QAudioDeviceInfo;

Device default_device() { return QAudioDeviceInfo::defaultOutputDevice(); }
QString name_of(const Device& device) { return device.deviceName(); }
void set_samples(QAudioFormat& format) {
  format.setCodec(QStringLiteral("audio/pcm"));
  format.setSampleSize(16);
  format.setSampleType(QAudioFormat::SignedInt);
  format.setByteOrder(Q_BYTE_ORDER == Q_BIG_ENDIAN ? QAudioFormat::BigEndian : QAudioFormat::LittleEndian);
}

#endif

}  // namespace

struct SoundPlayer::Output {
  Sink sink;
};

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
  const Device device = default_device();
  if (device.isNull()) {
    Q_EMIT told(tr("this computer has no audio device"));
    return;
  }
  QAudioFormat format;
  format.setSampleRate(static_cast<int>(options.sample_rate_hz));
  format.setChannelCount(1);
  set_samples(format);
  if (!device.isFormatSupported(format)) {
    Q_EMIT told(tr("the audio device %1 takes no single channel of 16 bits at %2 Hz")
                    .arg(name_of(device))
                    .arg(format.sampleRate()));
    return;
  }
  stream_ = std::make_unique<SoundStream>(options, input);
  output_.reset(new Output{Sink(device, format)});
  Sink& sink = output_->sink;
  sink.setBufferSize(format.bytesForDuration(static_cast<qint64>(1e6 * kBufferS)));
  connect(&sink, &Sink::stateChanged, this, [this](QAudio::State state) {
    const bool has_failed = state == QAudio::StoppedState && output_ && output_->sink.error() != QAudio::NoError;
    if (has_failed) Q_EMIT told(tr("the audio device has stopped"));
  });
  sink.start(stream_.get());
  if (sink.error() != QAudio::NoError) {
    Q_EMIT told(tr("the audio device %1 cannot be opened").arg(name_of(device)));
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

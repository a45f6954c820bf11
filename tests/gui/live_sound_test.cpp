#include <gtest/gtest.h>

#include <QCheckBox>
#include <QCoreApplication>
#include <QElapsedTimer>
#include <QLabel>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "apps/spinaltap-planner/drill/drill_panel.h"
#include "apps/spinaltap-planner/sound/sound_stream.h"

namespace spinaltap {
namespace {

std::vector<std::int16_t> read(SoundStream& stream, std::size_t samples) {
  const QByteArray bytes = stream.read(static_cast<qint64>(2 * samples));
  std::vector<std::int16_t> read(static_cast<std::size_t>(bytes.size()) / 2);
  std::memcpy(read.data(), bytes.constData(), 2 * read.size());
  return read;
}

TEST(SoundStream, GivesADeviceWhatTheDrillsSoundIs) {
  const DrillSoundOptions options{.edges = 2, .seed = 5};
  const auto input = std::make_shared<LiveInput>();
  SoundStream stream(options, input);
  DrillSound drill(options);
  // In air, through dense bone, out of it: pieces as no device asks for them.
  const std::vector<DrillSoundInput> drilled{
      {}, {1250.0, 0.0, 0.0, 0.0}, {1250.0, 60.0, 30.0, 1.8}, {1250.0, 25.0, 12.0, 0.3}, {1250.0, 0.0, 0.0, 0.0}};
  int loudest = 0;
  for (std::size_t n = 0; n < drilled.size(); ++n) {
    input->set({1.0, 2.0, 3.0, 0.4});  // which the next one, before anything is read, takes the place of
    input->set(drilled[n]);
    drill.set(drilled[n]);
    for (const std::size_t samples : {480U, 1U, 4801U}) {
      std::vector<float> expected(samples);
      drill.render(expected);
      const std::vector<std::int16_t> found = read(stream, samples);
      ASSERT_EQ(found.size(), samples);
      for (std::size_t k = 0; k < samples; ++k) {
        ASSERT_EQ(found[k], std::lround(32767.0F * expected[k])) << n << " " << k;
        loudest = std::max(loudest, std::abs(static_cast<int>(found[k])));
      }
    }
  }
  EXPECT_GT(loudest, 1000);
}

TEST(SoundStream, GivesWholeSamplesAndGoesOnWhereAnInputIsNone) {
  const auto input = std::make_shared<LiveInput>();
  SoundStream stream({}, input);
  input->set({1250.0, 60.0, 30.0, 1.8});
  EXPECT_EQ(stream.read(7).size(), 6);
  const auto energy = [&] {
    double sum = 0.0;
    for (const std::int16_t sample : read(stream, 24000)) sum += static_cast<double>(sample) * sample;
    return sum;
  };
  energy();  // until it turns
  const double before = energy();
  input->set({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0, 0.0});
  EXPECT_NEAR(energy() / before, 1.0, 0.1);
  EXPECT_EQ(stream.write("no", 2), -1);
}

/// Where no device can be: neither a server nor a card's settings.
TEST(LiveSound, SaysWhyNothingIsHeard) {
  qputenv("PULSE_SERVER", "unix:/nowhere/pulse");
  qputenv("ALSA_CONFIG_PATH", "/dev/null");
  PlanDocument document;
  DrillPlayer player(document);
  DrillPanel panel(document, player);
  auto* box = panel.findChild<QCheckBox*>(QStringLiteral("drill_sound"));
  auto* silence = panel.findChild<QLabel*>(QStringLiteral("drill_silence"));
  ASSERT_NE(box, nullptr);
  ASSERT_NE(silence, nullptr);
  EXPECT_FALSE(box->isChecked());  // off until it is asked for
  EXPECT_TRUE(silence->isHidden());
  QElapsedTimer clock;
  clock.start();
  box->click();
  EXPECT_LT(clock.elapsed(), 100);  // a device is looked for on another thread
  while (silence->isHidden() && clock.elapsed() < 20'000) {
    QCoreApplication::processEvents(QEventLoop::AllEvents, 10);
  }
  EXPECT_FALSE(silence->isHidden());
  EXPECT_EQ(silence->text().toStdString().substr(0, 20), "Nothing is heard: th");
  box->click();
  EXPECT_TRUE(silence->isHidden());
}

}  // namespace
}  // namespace spinaltap

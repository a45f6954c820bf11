#include <sndfile.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/spinaltap/command.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/recorded_setup.h"
#include "core/sound/breakthrough_listener.h"
#include "core/sound/session_sound.h"

namespace spinaltap {
namespace {

struct SoundOptions {
  std::filesystem::path record;
  std::filesystem::path output = "drill.wav";
  std::filesystem::path events;  ///< empty: none
  int rate_hz = 48000;
  int bits = 16;
  double volume = 1.0;
  int edges = 0;
  std::uint64_t seed = 1;
};

/// A WAV file that is being written. Of whole numbers: of floating-point ones libsndfile notes when it was written, and
/// no two would be the same.
class WavFile {
 public:
  WavFile(const std::filesystem::path& path, std::filesystem::path shown, int rate_hz, int bits)
      : shown_(std::move(shown)) {
    SF_INFO info{};
    info.samplerate = rate_hz;
    info.channels = 1;
    info.format = SF_FORMAT_WAV | (bits == 24 ? SF_FORMAT_PCM_24 : SF_FORMAT_PCM_16);
    file_.reset(sf_open(path.c_str(), SFM_WRITE, &info));
    if (!file_) fail_as(ErrorKind::disk, "cannot write ", shown_.string(), ": ", sf_strerror(nullptr));
  }
  void write(std::span<const float> samples) {
    const auto count = static_cast<sf_count_t>(samples.size());
    if (sf_write_float(file_.get(), samples.data(), count) != count) {
      fail_as(ErrorKind::disk, "cannot write ", shown_.string(), ": ", sf_strerror(file_.get()));
    }
  }
  void close() {
    // Its head goes out with the last bytes.
    const int trouble = sf_close(file_.release());
    if (trouble != 0) fail_as(ErrorKind::disk, "cannot write ", shown_.string(), ": ", sf_error_number(trouble));
  }

 private:
  struct Close {
    void operator()(SNDFILE* file) const { sf_close(file); }
  };
  std::filesystem::path shown_;
  std::unique_ptr<SNDFILE, Close> file_;
};

Json heard_json(const SessionRecord& record, std::span<const HeardBreakthrough> heard) {
  Json breakthroughs = Json::array(), times = Json::array();
  for (const SessionEvent& event : record.events) {
    if (event.kind != EventKind::breakthrough) continue;
    breakthroughs.push_back({{"time_s", event.time_s}, {"depth_mm", event.depth_mm}});
  }
  for (const HeardBreakthrough& one : heard) times.push_back({{"time_s", one.time_s}, {"tone_hz", one.tone_hz}});
  return {{"breakthroughs", breakthroughs}, {"heard", times}};
}

Json sound(const SoundOptions& options, const Progress& progress) {
  const SessionRecord record = read_record(options.record);
  const SessionSetup setup = recorded_setup(record.setup, options.record);
  if (record.cycles.empty()) fail(options.record.string(), " holds no cycle: there is nothing to hear");
  SessionSound session(setup, {.sample_rate_hz = static_cast<double>(options.rate_hz),
                               .edges = options.edges,
                               .volume = options.volume,
                               .seed = options.seed});
  ListenerOptions hearing;
  hearing.sample_rate_hz = static_cast<double>(options.rate_hz);
  hearing.floor_level *= std::min(1.0, options.volume);
  BreakthroughListener listener(hearing);

  StagedOutput output;
  WavFile wav(output.stage(options.output), options.output, options.rate_hz, options.bits);
  ProgressCounter counter(progress, "sound", record.cycles.size());
  std::vector<float> samples;
  for (const RecordedCycle& cycle : record.cycles) {
    session.add(cycle, samples);
    counter.add();
    if (samples.size() < 65536 && &cycle != &record.cycles.back()) continue;
    listener.hear(samples);
    wav.write(samples);
    samples.clear();
  }
  wav.close();
  const DrillSound& drill = session.drill();
  Json figures{{"sample_rate_hz", options.rate_hz},
               {"samples", drill.samples()},
               {"peak", drill.peak()},
               {"bent_samples", drill.bent()},
               {"rpm", setup.options.spindle.rpm},
               {"edges", drill.options().edges},
               {"seed", options.seed}};
  figures.update(heard_json(record, listener.heard()));
  if (!options.events.empty()) {
    Json file = format_head({.name = "spinaltap-sound"});
    file.update(figures);
    output.write(options.events, file.dump(1) + "\n");
  }
  output.commit();

  print_figure("sound", static_cast<double>(drill.samples()) / options.rate_hz, "s", 2);
  print_figure("edges that pass in a turn", std::to_string(drill.options().edges));
  print_figure("peak, of full scale", drill.peak(), "", 3);
  if (drill.bent() > 0) print_figure("samples bent to full scale", std::to_string(drill.bent()));
  for (const SessionEvent& event : record.events) {
    if (event.kind == EventKind::breakthrough) print_figure("breakthrough in the record", event.time_s, "s", 3);
  }
  for (const HeardBreakthrough& heard : listener.heard()) {
    print_figure("breakthrough in the sound", heard.time_s, "s", 3);
  }
  if (listener.heard().empty()) print_figure("breakthrough in the sound", "none");
  print_figure("written", options.output.string());
  return figures;
}

}  // namespace

void add_sound(CLI::App& program, Command& command) {
  const auto options = std::make_shared<SoundOptions>();
  CLI::App* app = add_command(program, command, "sound", "Make the sound of a recorded drilling: WAV",
                              "Example: spinaltap sound run.h5 -o drill.wav --events heard.json\n"
                              "Forces and densities are the record's, which spinaltap replay brings again bit for bit: "
                              "no bone is needed.\n"
                              "The same record and options give the same file, byte for byte.");
  app->add_option("record", options->record, "A record of drill --record")->required()->type_name("RECORD");
  app->add_option("-o,--output", options->output, "The sound to write, mono: .wav")
      ->capture_default_str()
      ->type_name("FILE");
  app->add_option("--events", options->events,
                  "Also write when the drill broke through by the record, and when that was heard, s: .json")
      ->type_name("FILE");
  app->add_option("--rate", options->rate_hz, "Samples a second, Hz")
      ->capture_default_str()
      ->check(CLI::Range(22050, 192000))
      ->type_name("HZ");
  app->add_option("--bits", options->bits, "Bits a sample")
      ->capture_default_str()
      ->check(CLI::IsMember({16, 24}))
      ->type_name("N");
  app->add_option("--volume", options->volume, "Times as loud; what would go beyond full scale is bent to it")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 4.0))
      ->type_name("TIMES");
  app->add_option("--edges", options->edges, "Cutting edges that pass in a turn; 0: 2 of a drill, 8 of a burr")
      ->capture_default_str()
      ->check(CLI::Range(0, 64))
      ->type_name("N");
  app->add_option("--seed", options->seed, "Of the noise of chips")->capture_default_str()->type_name("N");
  command.outputs = [options] { return std::vector{options->output, options->events}; };
  command.run = [options](const Progress& progress) { return sound(*options, progress); };
}

}  // namespace spinaltap

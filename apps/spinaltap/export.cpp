#include <fstream>
#include <memory>

#include "apps/spinaltap/command.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/session/record/session_record.h"

namespace spinaltap {
namespace {

struct ExportOptions {
  std::filesystem::path record, cycles, events;
};

/// `write` puts rows into a stream; a disk that is full is an error.
template <class Write>
void write_rows(const SessionRecord& record, const std::filesystem::path& path, const Write& write) {
  std::ofstream csv(path, std::ios::binary);
  write(record, csv);
  csv.close();
  if (!csv) fail_as(ErrorKind::disk, "cannot write ", path.string(), ": is the disk full?");
}

Json export_record(const ExportOptions& options) {
  const SessionRecord record = read_record(options.record);
  StagedOutput output;
  if (!options.cycles.empty()) write_rows(record, output.stage(options.cycles), write_record_csv);
  if (!options.events.empty()) write_rows(record, output.stage(options.events), write_events_csv);
  output.commit();
  print_figure("record", record.is_whole ? "whole" : "cut short");
  print_figure("cycles", static_cast<double>(record.cycles.size()), "", 0);
  print_figure("events", static_cast<double>(record.events.size()), "", 0);
  if (record.lost > 0) print_figure("cycles lost", static_cast<double>(record.lost), "", 0);
  return {{"is_whole", record.is_whole},
          {"cycles", record.cycles.size()},
          {"events", record.events.size()},
          {"lost", record.lost}};
}

}  // namespace

void add_export(CLI::App& program, Command& command) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* app = add_command(program, command, "export", "Write a recorded drilling as CSV, one row a cycle",
                              "Example: spinaltap export session.h5 -o session.csv --events events.csv\n"
                              "Also while it is being recorded. Units are in the names of the columns.");
  app->add_option("record", options->record, "A record of drill --record")->required()->type_name("RECORD");
  auto* cycles = app->add_option("-o,--output", options->cycles, "Write the cycles to this file")->type_name("FILE");
  auto* events = app->add_option("--events", options->events, "Write the events to this file")->type_name("FILE");
  command.run = [options, cycles, events](const Progress&) {
    if (cycles->count() + events->count() == 0) fail("expected a file to write: -o FILE, --events FILE or both");
    return export_record(*options);
  };
}

}  // namespace spinaltap

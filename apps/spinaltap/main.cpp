#include <tbb/global_control.h>

#include <array>
#include <cstdio>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "apps/spinaltap/cluster/study_commands.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/terminal_progress.h"
#include "core/base/error.h"
#include "core/base/process_changes.h"
#include "core/base/text_writer.h"
#include "core/base/version.h"

namespace spinaltap {

CLI::App* add_command(CLI::App& program, Command& command, const std::string& name, const std::string& description,
                      const std::string& footer) {
  CLI::App* app = program.add_subcommand(name, description);
  app->footer(footer);
  app->add_option("--json", command.json_file, "Write the figures to this file as JSON")->type_name("FILE");
  app->add_flag("--force", command.is_forced, "Replace outputs that are there; without it they are an error");
  app->add_option("--threads", command.threads, "Threads to use; 0: one for each core")
      ->check(CLI::Range(0, 1024))
      ->type_name("N");
  command.app = app;
  return app;
}

void print_figure(const std::string& name, double value, const std::string& unit, int digits) {
  std::printf("  %-34s %14s %s\n", name.c_str(), fixed_text(value, digits).c_str(), unit.c_str());
}

void print_figure(const std::string& name, const std::string& value) {
  std::printf("  %-34s %s\n", name.c_str(), value.c_str());
}

namespace {

/// Libraries speak of their options' names, and of the folders that outputs are staged in; who types commands knows
/// flags, and files by their last names.
std::string as_typed(std::string text) {
  constexpr std::string_view kStaged = ".spinaltap-partial-";
  if (const std::size_t at = text.find(kStaged); at != std::string::npos) {
    if (const std::size_t end = text.find('/', at); end != std::string::npos) text.erase(at, end + 1 - at);
  }
  for (const auto& [name, flag] :
       {std::pair{"CtReadOptions::series", "--series"}, std::pair{"CtReadOptions::stack", "--stack"},
        std::pair{"CtReadOptions::resample", "--resample"},
        std::pair{"CtReadOptions::hu", "--hu-scale, --hu-offset"}}) {
    const std::size_t at = text.find(name);
    if (at != std::string::npos) text.replace(at, std::string_view(name).size(), flag);
  }
  return text;
}

/// Returns the exit code.
int run_program(int argc, char** argv) {
  CLI::App program(
      "SpinalTap: from a CT of a vertebra to a bone that can be drilled at haptic rate.\n"
      "Lengths are in mm, positions in patient LPS (x to the patient's left, y to the back, z to the head).\n"
      "Research and training software, not a medical device.");
  program.name("spinaltap");
  const std::string version_line = std::string("spinaltap ") + version();
  program.set_version_flag("--version", version_line);
  program.require_subcommand(1);

  std::array<Command, 30> commands;
  add_demo(program, commands[0]);
  add_phantom(program, commands[1]);
  add_info(program, commands[2]);
  add_segment(program, commands[3]);
  add_points(program, commands[4]);
  add_fit(program, commands[5]);
  add_eval(program, commands[6]);
  add_bake(program, commands[7]);
  add_plan(program, commands[8]);
  add_grade(program, commands[9]);
  add_drill(program, commands[10]);
  add_link(program, commands[11]);
  add_replay(program, commands[12]);
  add_export(program, commands[13]);
  add_heat(program, commands[14]);
  add_study(program, commands[15]);
  add_merge(program, commands[16]);
  add_mesh(program, commands[17]);
  add_render(program, commands[18]);
  add_diff(program, commands[19]);
  add_compare(program, commands[20]);
  add_validate(program, commands[21]);
  add_bench(program, commands[22]);
  add_register(program, commands[23]);
  add_pivot(program, commands[24]);
  add_sound(program, commands[25]);
  add_bench_link(program, commands[26]);
  add_study_submit(program, commands[27]);
  add_study_status(program, commands[28]);
  add_study_resume(program, commands[29]);
  std::vector<std::string> help_words;
  CLI::App* const help = program.add_subcommand("help", "Show how a command is used: spinaltap help bake");
  help->add_option("command", help_words, "Its name, such as bake, or study submit");
  CLI::App* const show_version = program.add_subcommand("version", "Print the version");
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);
    std::fprintf(stderr, "spinaltap: %s\n", usage_error(program, error).c_str());
    return kUsageOrInput;
  }
  if (help->parsed()) std::fputs(help_on(program, help_words).c_str(), stdout);
  if (show_version->parsed()) std::puts(version_line.c_str());
  for (const Command& command : commands) {
    if (!command.app->parsed() || !command.app->get_subcommands().empty()) continue;
    check_outputs(command);
    check_inputs(*command.app);
    std::unique_ptr<tbb::global_control> limit;
    if (command.threads > 0) {
      limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<std::size_t>(command.threads));
    }
    Json figures;
    try {
      figures = command.run(terminal_progress());
    } catch (const Cancelled&) {
      std::fprintf(stderr, "spinaltap: %s stopped: %s\n", command.app->get_name().c_str(), command.after_stop.c_str());
      return kCancelled;
    }
    if (!command.json_file.empty()) {
      Json file = format_head({.name = "spinaltap-figures"});
      file.update(figures);
      write_json(file, command.json_file);
    }
    return command.exit_code;
  }
  return 0;
}

}  // namespace
}  // namespace spinaltap

int main(int argc, char** argv) {
  spinaltap::allow_process_changes({.silences_decoders = true, .silences_hdf5_at_exit = true});
  try {
    return spinaltap::run_program(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "spinaltap: not enough memory\n");
  } catch (const spinaltap::Error& error) {
    std::fprintf(stderr, "spinaltap: %s\n", spinaltap::as_typed(error.what()).c_str());
    if (error.kind() == spinaltap::ErrorKind::internal) return spinaltap::kInternal;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "spinaltap: %s\n", spinaltap::as_typed(error.what()).c_str());
  }
  return spinaltap::kUsageOrInput;
}

#include "apps/spinaltap/command.h"
namespace spinaltap {
void add_demo(CLI::App& program, Command& command) { add_command(program, command, "demo", "", ""); }
}

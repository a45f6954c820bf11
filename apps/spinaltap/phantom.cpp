#include "apps/spinaltap/command.h"
namespace spinaltap {
void add_phantom(CLI::App& program, Command& command) { add_command(program, command, "phantom", "", ""); }
}

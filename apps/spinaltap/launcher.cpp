// `spinaltap` as it is typed: says its version, and for all else becomes the program that has the commands. That is
// linked to OpenVDB, and to relocate it takes longer than all else that --version does.

#include <limits.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

int main(int argc, char** argv) {
  constexpr int kUsageOrInput = 2;  // as in command.h, without what that includes
  if (argc == 2 && (std::strcmp(argv[1], "--version") == 0 || std::strcmp(argv[1], "version") == 0)) {
    std::puts("spinaltap " SPINALTAP_VERSION);
    return 0;
  }
  // Links that lead here do not count: the other program stands beside the folder of the file itself.
  char self[PATH_MAX] = {};
  if (readlink("/proc/self/exe", self, sizeof self - 1) < 0) {
    std::fprintf(stderr, "spinaltap: cannot read /proc/self/exe: %s\n", std::strerror(errno));
    return kUsageOrInput;
  }
  *std::strrchr(self, '/') = '\0';
  constexpr char kCommands[] = "/../libexec/spinaltap-commands";
  char commands[sizeof self + sizeof kCommands];
  std::snprintf(commands, sizeof commands, "%s%s", self, kCommands);
  execv(commands, argv);
  std::fprintf(stderr, "spinaltap: cannot run %s: %s\n", commands, std::strerror(errno));
  return kUsageOrInput;
}

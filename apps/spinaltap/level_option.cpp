#include "apps/spinaltap/level_option.h"

#include <optional>
#include <string>

namespace spinaltap {

CLI::Option* add_level(CLI::App& app, Level& level) {
  return app
      .add_option_function<std::string>(
          "--level",
          [&level](const std::string& name) {
            const std::optional<Level> found = level_from_name(name);
            if (!found) throw CLI::ValidationError("--level", "expected a vertebra such as T11 or L3, found " + name);
            level = *found;
          },
          "Which bone is meant, such as L3, where the file holds several")
      ->type_name("LEVEL");
}

}  // namespace spinaltap

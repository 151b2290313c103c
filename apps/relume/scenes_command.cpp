#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "builtin_scenes/builtin.h"
#include "command.h"

namespace relume::cli {

Command scenes_command() {
  const auto names_only = std::make_shared<bool>(false);
  return {
      .name = "scenes",
      .summary = "List the built-in scenes.",
      .examples = {{"relume scenes", "names and what they are for"},
                   {"relume scenes --names", "names alone, for scripts"}},
      .arguments = {},
      .options = {{{"names", names_only.get(), "Names alone, one a line"}}},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run =
          [names_only] {
            for (const BuiltinScene& scene : builtin_scenes()) {
              const std::string_view summary = *names_only ? "" : scene.summary;
              std::puts(
                  (summary.empty() ? std::string(scene.name) : fmt::format("{:18} {}", scene.name, summary)).c_str());
            }
            return kExitDone;
          },
  };
}

}  // namespace relume::cli

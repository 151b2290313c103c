#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "cli/command.h"
#include "render/settings.h"
#include "settings/settings_json.h"

namespace relume::cli {
namespace {

struct SettingsOptions {
  std::string preset;
  bool json = false;
  bool markdown = false;
};

std::string to_text(const SettingList& list) {
  std::string text;
  for (const Setting& setting : list) {
    text += fmt::format("{:24} {:12} {}\n", setting.name, to_string(setting), describe_type(setting));
  }
  return text;
}

int run_settings(const SettingsOptions& options) {
  AllSettings settings = resolve({.preset = options.preset});
  const SettingList list = describe(settings);
  const std::string text = options.markdown ? settings_reference()
                           : options.json   ? settings_to_json(list) + "\n"
                                            : to_text(list);
  std::fputs(text.c_str(), stdout);
  return kExitDone;
}

}  // namespace

Command settings_command() {
  const auto options = std::make_shared<SettingsOptions>();
  return {
      .name = "settings",
      .summary = "List all settings.",
      .examples = {{"relume settings", "names, values and ranges"},
                   {"relume settings --preset reference --json > my.json", "a file to change, for render --settings"},
                   {"relume settings --markdown > docs/settings.md", "the reference page"}},
      .arguments = {},
      .options = {{{"preset", &options->preset, "Use the values of this preset"}, "NAME", 0, Completion::preset},
                  {{"json", &options->json, "Print as a settings file"}},
                  {{"markdown", &options->markdown, "Print as the reference page, with defaults"}}},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [options] { return run_settings(*options); },
  };
}

}  // namespace relume::cli

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/file_roles.h"
#include "cli/man_page.h"
#include "files/atomic_file.h"
#include "settings/nearest_name.h"

namespace relume::cli {
namespace {

std::string page_of(const std::vector<Command>& commands, const std::string& name) {
  if (name.empty()) return man_overview(commands);
  const auto found = std::find_if(commands.begin(), commands.end(), [&](const Command& c) { return c.name == name; });
  if (found != commands.end()) return man_page(*found, commands);
  std::vector<std::string> names;
  for (const Command& command : commands) names.emplace_back(command.name);
  throw UsageError(fmt::format("there is no command '{}'{}", name, suggestion(name, names)));
}

void write_pages(const std::vector<Command>& commands, const std::filesystem::path& folder) {
  make_output_folder(folder);
  std::vector<std::pair<std::filesystem::path, std::string>> files = {{folder / "relume.1", man_overview(commands)}};
  for (const Command& command : commands) {
    files.emplace_back(folder / (man_page_name(command) + ".1"), man_page(command, commands));
  }
  for (const auto& [file, page] : files) check_output_file(file);
  write_files(files);
}

int run_man(const std::vector<Command>& commands, const std::string& name, const std::string& folder) {
  if (folder.empty()) {
    std::fputs(page_of(commands, name).c_str(), stdout);
  } else if (name.empty()) {
    write_pages(commands, folder);
  } else {
    throw UsageError(fmt::format("man writes all pages to '{}'; remove the command '{}'", folder, name));
  }
  return kExitDone;
}

}  // namespace

Command man_command(const std::vector<Command>& commands) {
  const auto name = std::make_shared<std::string>();
  const auto folder = std::make_shared<std::string>();
  return {
      .name = "man",
      .summary = "Print a manual page.",
      .examples = {{"relume man render | man -l -", "read the page of a command"},
                   {"relume man -o man1", "write all pages: man1/relume.1, man1/relume-render.1 ..."}},
      .arguments = {{"COMMAND", name.get(), "Command to explain; without it, relume itself", false,
                     Completion::command}},
      .options = {{{"output", folder.get(), "Write all pages into this folder"}, "FOLDER", 'o', Completion::file}},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [&commands, name, folder] { return run_man(commands, *name, *folder); },
  };
}

}  // namespace relume::cli

#include "settings/settings_docs.h"

#include <fmt/format.h>

namespace relume {
namespace {

/// Escapes text so that it does not end its table cell.
std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string code(std::string_view text) { return text.empty() ? "" : fmt::format("`{}`", cell(text)); }

std::string row(const Setting& setting) {
  const std::string columns[] = {code("--" + setting.name),          cell(describe_type(setting)),
                                 code(to_string(setting)),           setting.traits.resets_history ? "yes" : "",
                                 setting.traits.biases ? "yes" : "", cell(setting.help)};
  std::string text = "|";
  for (const std::string& column : columns) text += (column.empty() ? "" : " " + column) + " |";
  return text + "\n";
}

}  // namespace

SettingList flatten(const std::vector<SettingGroup>& groups) {
  SettingList list;
  for (const SettingGroup& group : groups) list.insert(list.end(), group.settings.begin(), group.settings.end());
  return list;
}

std::string settings_to_markdown(const std::vector<SettingGroup>& groups) {
  std::string text;
  for (const SettingGroup& group : groups) {
    text += fmt::format("\n## {}\n\n{}\n\n", group.title, group.summary);
    text += "| flag | value | default | resets | biases | description |\n";
    text += "|---|---|---|---|---|---|\n";
    for (const Setting& setting : group.settings) text += row(setting);
  }
  return text;
}

}  // namespace relume

#include "viewer/model/setting_search.h"

#include <algorithm>
#include <cctype>

namespace relume::viewer {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

}  // namespace

bool matches(const Setting& setting, std::string_view query) {
  std::string text = setting.name + "\n" + std::string(setting.help);
  if (const auto* choice = std::get_if<ChoiceRef>(&setting.value)) {
    for (const std::string_view name : choice->names) text += "\n" + std::string(name);
  }
  text = lower(text);
  const std::string words = lower(query);
  for (size_t begin = words.find_first_not_of(' '); begin != std::string::npos;) {
    const size_t end = std::min(words.find(' ', begin), words.size());
    if (text.find(words.substr(begin, end - begin)) == std::string::npos) return false;
    begin = words.find_first_not_of(' ', end);
  }
  return true;
}

void set_automatic(const OptionalNumberRef& number, bool automatic, float present) {
  if (automatic == !number.value->has_value()) return;
  *number.value = automatic ? std::nullopt : std::optional(present);
}

}  // namespace relume::viewer

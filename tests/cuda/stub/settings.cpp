#include "stub/settings.h"

#include <cstdio>
#include <cstdlib>
#include <sstream>

namespace stub {
namespace {

[[noreturn]] void refuse(const std::string& word) {
  std::fprintf(stderr, "stub driver: unknown setting '%s'; tests/cuda/README.md lists them\n", word.c_str());
  std::abort();
}

void add_failure(Settings& settings, const std::string& word, const std::string& value) {
  const size_t first = value.find(':');
  const size_t second = value.find(':', first + 1);
  if (first == std::string::npos || second == std::string::npos) refuse(word);
  const size_t call = std::stoul(value.substr(first + 1, second - first - 1));
  settings.failures[{value.substr(0, first), call}] = std::stoi(value.substr(second + 1));
}

bool set_number(Settings& s, const std::string& name, unsigned long value) {
  if (name == "version")
    s.version = static_cast<int>(value);
  else if (name == "devices")
    s.devices = static_cast<int>(value);
  else if (name == "capability")
    s.capability = static_cast<int>(value);
  else if (name == "managed")
    s.managed = value != 0;
  else if (name == "concurrent")
    s.concurrent = value != 0;
  else if (name == "prohibited")
    s.prohibited = value != 0;
  else if (name == "memory")
    s.memory_mib = value;
  else if (name == "stack")
    s.stack = static_cast<int>(value);
  else if (name == "eager")
    s.eager = value != 0;
  else if (name == "open")
    s.open = value != 0;
  else if (name == "seed")
    s.seed = value;
  else if (name == "lose")
    s.lose = value;
  else if (name == "microseconds")
    s.thread_s = 1e-6 * static_cast<double>(value);
  else
    return false;
  return true;
}

}  // namespace

Settings parse_settings(const std::string& text) {
  Settings settings;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const size_t equals = word.find('=');
    if (equals == std::string::npos) refuse(word);
    const std::string name = word.substr(0, equals);
    const std::string value = word.substr(equals + 1);
    if (name == "fail") {
      add_failure(settings, word, value);
    } else if (name == "log") {
      settings.log_file = value;
    } else if (!set_number(settings, name, std::stoul(value))) {
      refuse(word);
    }
  }
  return settings;
}

}  // namespace stub

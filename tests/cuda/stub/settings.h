// Properties of the stub driver and its devices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace stub {

struct Settings {
  int version = 13000;
  int devices = 1;
  int capability = 90;
  bool managed = true;
  bool concurrent = true;
  bool prohibited = false;
  size_t memory_mib = 4096;
  int stack = 0;
  bool eager = false;
  bool open = false;
  uint64_t seed = 0;
  size_t lose = 0;
  double thread_s = 1e-6;  ///< of the clock of the device
  std::string log_file;
  /// Function and number of a call -> the result that it returns.
  std::map<std::pair<std::string, size_t>, int> failures;
};

/// Settings from the text of relume_stub_configure(). Aborts on unknown words.
Settings parse_settings(const std::string& text);

}  // namespace stub

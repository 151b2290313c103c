#include "console.h"

#include <cstdint>
#include <cstdio>

#include <fmt/format.h>

namespace relume::cli {

void log_info(const Verbosity& verbosity, std::string_view text) {
  if (!verbosity.quiet) std::fputs(fmt::format("{}\n", text).c_str(), stderr);
}

void tell_more(const Verbosity& verbosity, std::string_view text) {
  if (verbosity.verbose) log_info(verbosity, text);
}

std::string interrupt_notice(const Verbosity& verbosity, std::string_view unit) {
  return verbosity.quiet ? "" : fmt::format("stopping once {} is complete; interrupt again to abort", unit);
}

std::string printable(std::string_view text) {
  constexpr unsigned char kDelete = 0x7f;
  std::string line;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= ' ' && code != kDelete) {
      line += c;
    } else if (c == '\n') {
      line += "\\n";
    } else if (c == '\t') {
      line += "\\t";
    } else {
      line += fmt::format("\\x{:02x}", code);
    }
  }
  return line;
}

void warn(std::string_view text) { std::fputs(fmt::format("warning: {}\n", printable(text)).c_str(), stderr); }

void warn_all(const Verbosity& verbosity, const std::vector<std::string>& warnings) {
  constexpr size_t kShown = 10;
  for (size_t i = 0; i < warnings.size(); ++i) {
    if (i == kShown && !verbosity.verbose) {
      return warn(fmt::format("and {} more; `relume info` lists all", warnings.size() - kShown));
    }
    warn(warnings[i]);
  }
}

std::string format_bytes(uint64_t bytes) {
  const auto amount = static_cast<double>(bytes);
  if (bytes >= uint64_t{1} << 30) return fmt::format("{:.1f} GiB", amount / (uint64_t{1} << 30));
  if (bytes >= uint64_t{1} << 20) return fmt::format("{:.0f} MiB", amount / (uint64_t{1} << 20));
  return fmt::format("{:.0f} KiB", amount / 1024);
}

std::string format_count(uint64_t count) {
  std::string text = std::to_string(count);
  for (size_t position = text.size(); position > 3; position -= 3) text.insert(position - 3, 1, ' ');
  return text;
}

}  // namespace relume::cli

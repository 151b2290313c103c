#include "cli/console.h"

#include <cstdint>
#include <cstdio>

#include <fmt/format.h>

#include "relume/scene.h"

namespace relume::cli {
namespace {

/// "FILE: ", if the sentence begins with one of `files`; the longest match wins.
std::string place_of(const std::string& sentence, const std::vector<std::filesystem::path>& files) {
  std::string place;
  for (const std::filesystem::path& file : files) {
    const std::string start = file.string() + ": ";
    if (start.size() > place.size() && sentence.starts_with(start)) place = start;
  }
  return place;
}

}  // namespace

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

std::string_view first_characters(std::string_view text, int columns) {
  if (columns <= 0) return text;
  int count = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool continues = (static_cast<unsigned char>(text[i]) & 0xc0u) == 0x80u;
    if (!continues && ++count > columns) return text.substr(0, i);
  }
  return text;
}

void warn(std::string_view text) { std::fputs(fmt::format("warning: {}\n", printable(text)).c_str(), stderr); }

std::vector<std::string> name_files_once(const std::vector<std::string>& sentences,
                                         const std::vector<std::filesystem::path>& files) {
  std::vector<std::string> result;
  std::string last;
  for (const std::string& sentence : sentences) {
    const std::string place = place_of(sentence, files);
    result.push_back(place == last ? sentence.substr(place.size()) : sentence);
    last = place;
  }
  return result;
}

void warn_all(const Verbosity& verbosity, const std::vector<std::string>& warnings,
              const std::vector<std::filesystem::path>& files) {
  constexpr size_t kShown = 10;
  const std::vector<std::string> sentences = name_files_once(warnings, files);
  for (size_t i = 0; i < sentences.size(); ++i) {
    if (i == kShown && !verbosity.verbose) {
      return warn(fmt::format("and {} more; `relume info` lists all", sentences.size() - kShown));
    }
    warn(sentences[i]);
  }
}

void warn_all(const Verbosity& verbosity, const Scene& scene) {
  warn_all(verbosity, scene.warnings, scene.source_files);
  for (const std::string& note : name_files_once(scene.notes, scene.source_files))
    tell_more(verbosity, printable(note));
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

// Messages on standard error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.h"

namespace relume {
struct Scene;
}

namespace relume::cli {

/// Printed unless --quiet.
void log_info(const Verbosity& verbosity, std::string_view text);
/// Printed only with --verbose.
void tell_more(const Verbosity& verbosity, std::string_view text);
/// Message for InterruptGuard that work stops once `unit` is complete; empty if quiet.
std::string interrupt_notice(const Verbosity& verbosity, std::string_view unit);

/// `text` on one line: control characters, as in names from damaged files, become \n, \t or \x1b.
std::string printable(std::string_view text);
/// The first `columns` characters of UTF-8 text, never cut within one; 0 or less: the whole text. Wide characters count
/// as one.
std::string_view first_characters(std::string_view text, int columns);
/// Always printed, on one line with the prefix "warning: ".
void warn(std::string_view text);
/// Prints the first ten warnings and the number of the others; with --verbose all. Names each of `files` once, like
/// name_files_once().
void warn_all(const Verbosity& verbosity, const std::vector<std::string>& warnings,
              const std::vector<std::filesystem::path>& files);
/// Prints the scene's warnings, and with --verbose its notes.
void warn_all(const Verbosity& verbosity, const Scene& scene);
/// Removes the name of one of `files` from the start of a sentence if the sentence before names the same file.
std::vector<std::string> name_files_once(const std::vector<std::string>& sentences,
                                         const std::vector<std::filesystem::path>& files);

/// "1.2 GiB", "340 MiB", "12 KiB".
std::string format_bytes(uint64_t bytes);
/// "1 234 567".
std::string format_count(uint64_t count);

}  // namespace relume::cli

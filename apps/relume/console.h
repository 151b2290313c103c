// What the program says on standard error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"

namespace relume {
struct Scene;
}

namespace relume::cli {

/// Printed unless --quiet.
void log_info(const Verbosity& verbosity, std::string_view text);
/// Printed with --verbose only.
void tell_more(const Verbosity& verbosity, std::string_view text);
/// For InterruptGuard: that work stops once `unit` is complete; empty if quiet.
std::string interrupt_notice(const Verbosity& verbosity, std::string_view unit);

/// `text` on one line: control characters, which names in damaged files may have, become \n, \t or \x1b.
std::string printable(std::string_view text);
/// The first `columns` characters of UTF-8 text, which is never cut within one; 0 or less: all of it. Wide characters
/// count as one.
std::string_view first_characters(std::string_view text, int columns);
/// Always printed, on one line with "warning: " before it.
void warn(std::string_view text);
/// The first ten, and how many more there are; all with --verbose. Names each of `files` once, as name_files_once()
/// does.
void warn_all(const Verbosity& verbosity, const std::vector<std::string>& warnings,
              const std::vector<std::filesystem::path>& files);
/// The scene's warnings, and with --verbose its notes.
void warn_all(const Verbosity& verbosity, const Scene& scene);
/// Sentences that begin with the name of one of `files`, as those of loaders do: without it if the sentence before
/// names the same file.
std::vector<std::string> name_files_once(const std::vector<std::string>& sentences,
                                         const std::vector<std::filesystem::path>& files);

/// "1.2 GiB", "340 MiB", "12 KiB".
std::string format_bytes(uint64_t bytes);
/// "1 234 567".
std::string format_count(uint64_t count);

}  // namespace relume::cli

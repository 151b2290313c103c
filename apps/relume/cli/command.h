// A command of the program as data. Command line, help and shell completion are generated from it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "relume/error.h"
#include "settings/settings_docs.h"

namespace relume::cli {

// Exit codes. 0 only if all requested output was written.
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitInterrupted = 130;  ///< 128 + SIGINT, as shells report it

/// An error in the command line; exit code kExitUsage.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// The completion that the shell offers for a value; choices and booleans need none.
enum class Completion { none, file, scene, preset, experiment, command, shell };

struct Argument {
  std::string_view name;  ///< name in the help: "SCENE"
  std::string* value = nullptr;
  std::string help;
  bool required = true;
  Completion completion = Completion::file;
  bool repeats = false;                        ///< takes all remaining arguments; the values are joined by commas
  std::vector<std::string>* values = nullptr;  ///< receives them one by one in place of `value`
};

struct Option {
  Setting setting;                   ///< "--" + name; booleans take no value
  std::string_view value_name = "";  ///< name in the help: "FILE"; empty: from the setting's type
  char letter = 0;                   ///< "-o"; 0: none
  Completion completion = Completion::none;
  bool repeats = false;  ///< may be repeated; the values are joined by commas
};

struct Example {
  std::string_view line;
  std::string_view meaning;
};

/// A folder below the home folder for a command's files.
struct UserFolder {
  std::string_view variable;    ///< environment variable whose value replaces `below_home`
  std::string_view below_home;  ///< ".cache"
  std::string_view path;        ///< path below both
  std::string_view contents;
};

inline constexpr UserFolder kReferenceFolder{"XDG_CACHE_HOME", ".cache", "relume/references/",
                                             "Cache of rendered references, shared by all comparisons of a scene."};
inline constexpr UserFolder kBookmarkFolder{"XDG_STATE_HOME", ".local/state", "relume/bookmarks/",
                                            "Bookmarks of the viewer, one file per scene."};

struct Command {
  std::string_view name;
  std::string_view summary;
  std::vector<Example> examples;
  std::vector<Argument> arguments;
  std::vector<Option> options;
  /// Further options. They are collected in `setting_flags` instead of assigned, because other sources apply first.
  std::vector<SettingGroup> setting_groups;
  std::vector<std::pair<std::string, std::string>>* setting_flags = nullptr;
  std::function<int()> run;  ///< returns the exit code; may throw Error
  std::vector<UserFolder> folders = {};
  /// Names of the options and settings in `--help`, in order; `--help-all` shows all. Empty: both show all.
  std::vector<std::string_view> essentials = {};
};

/// Amount of output on standard error.
struct Verbosity {
  bool quiet = false;  ///< warnings and errors only
  bool verbose = false;
};

/// "--quiet" and "--verbose", for commands that take time.
std::vector<Option> verbosity_options(Verbosity& verbosity);

// One function per file; `verbosity` outlives the command.
Command render_command(Verbosity& verbosity);
Command view_command(Verbosity& verbosity);
Command serve_command(Verbosity& verbosity);
Command scenes_command();
Command export_command(Verbosity& verbosity);
Command info_command(Verbosity& verbosity);
Command metrics_command();
Command merge_command(Verbosity& verbosity);
Command compare_command(Verbosity& verbosity);
Command experiment_command(Verbosity& verbosity);
Command survey_command(Verbosity& verbosity);
Command settings_command();
Command devices_command();
// `commands`: all commands of the program, including these once the list is complete.
Command man_command(const std::vector<Command>& commands);
Command completion_command(const std::vector<Command>& commands);

}  // namespace relume::cli

// A command of the program as data. The command line, its help and the shell's completion are made from it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "relume/error.h"
#include "settings/settings_docs.h"

namespace relume::cli {

// Exit codes. 0 only if what was asked for was written.
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitInterrupted = 130;  ///< 128 + SIGINT, as shells report it

/// The command line itself is wrong: kExitUsage.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// What the shell offers for a value; choices and booleans need none of it.
enum class Completion { none, file, scene, preset, experiment, command, shell };

struct Argument {
  std::string_view name;  ///< as help shows it: "SCENE"
  std::string* value = nullptr;
  std::string help;
  bool required = true;
  Completion completion = Completion::file;
  bool repeats = false;  ///< takes all that is left; the values are joined by commas
};

struct Option {
  Setting setting;                   ///< "--" + name; booleans take no value
  std::string_view value_name = "";  ///< as help shows it: "FILE"; empty: from the setting's type
  char letter = 0;                   ///< "-o"; 0: none
  Completion completion = Completion::none;
  bool repeats = false;  ///< may be given several times; the values are joined by commas
};

struct Example {
  std::string_view line;
  std::string_view meaning;
};

/// A folder below the home folder in which a command keeps files.
struct UserFolder {
  std::string_view variable;    ///< environment variable whose value replaces `below_home`
  std::string_view below_home;  ///< ".cache"
  std::string_view path;        ///< below both
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
  /// Further options that are not assigned but collected in `setting_flags`, because something else comes first.
  std::vector<SettingGroup> setting_groups;
  std::vector<std::pair<std::string, std::string>>* setting_flags = nullptr;
  std::function<int()> run;  ///< returns the exit code; may throw Error
  std::vector<UserFolder> folders = {};
  /// Names of the options and settings that `--help` shows, in its order; `--help-all` shows all. Empty: both show all.
  std::vector<std::string_view> essentials = {};
};

/// How much goes to standard error.
struct Verbosity {
  bool quiet = false;  ///< warnings and errors only
  bool verbose = false;
};

/// "--quiet" and "--verbose", which commands that take time have.
std::vector<Option> verbosity_options(Verbosity& verbosity);

// One function a file; `verbosity` outlives the command.
Command render_command(Verbosity& verbosity);
Command view_command(Verbosity& verbosity);
Command scenes_command();
Command export_command(Verbosity& verbosity);
Command info_command(Verbosity& verbosity);
Command metrics_command();
Command compare_command(Verbosity& verbosity);
Command experiment_command(Verbosity& verbosity);
Command settings_command();
Command devices_command();
// `commands`: all of the program, themselves included once it is complete.
Command man_command(const std::vector<Command>& commands);
Command completion_command(const std::vector<Command>& commands);

}  // namespace relume::cli

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/file_roles.h"
#include "cli/reports.h"
#include "files/extension.h"
#include "relume/merge.h"

namespace relume::cli {
namespace {

struct MergeOptions {
  std::vector<std::string> parts;
  std::string output;
  bool keep_sums = false;
};

/// "wrote out.exr with 96 samples per pixel; 32 samples between them are missing"
std::string text_of(const MergeReport& report, const std::string& output) {
  std::string text = fmt::format("wrote {} with {}", output, samples_text(report.samples));
  if (report.replicas > 0) text += fmt::format(" of {} independent renders", report.replicas);
  if (report.missing == 0) return text;
  return fmt::format("{}; {} {} no part ({})", text, report.missing,
                     report.missing == 1 ? "earlier sample is in" : "earlier samples are in", report.ranges);
}

int run_merge(const MergeOptions& options, const Verbosity& verbosity) {
  if (options.output.empty()) throw UsageError("merge needs -o FILE; see relume merge --help");
  if (lower_extension(options.output) != ".exr") {
    throw UsageError(fmt::format("{}: merged images are written as .exr; choose this extension", options.output));
  }
  FileRoles roles;
  for (const std::string& part : options.parts) roles.reads("PART", part);
  roles.writes("-o", options.output);
  check_no_folder(options.output);
  check_output_file(options.output);
  const MergeReport report =
      merge_images({options.parts.begin(), options.parts.end()}, options.output, options.keep_sums);
  log_info(verbosity, text_of(report, options.output));
  return kExitDone;
}

}  // namespace

Command merge_command(Verbosity& verbosity) {
  const auto options = std::make_shared<MergeOptions>();
  Command command{
      .name = "merge",
      .summary = "Merge images whose samples were rendered in parts.",
      .examples = {{"relume merge part1.exr part2.exr -o out.exr", "the image of all samples"},
                   {"relume merge day1/*.exr -o day1.exr --keep-sums", "the same, to be merged again"}},
      .arguments = {{.name = "PART",
                     .help = "Image of relume render --sample-range, in any order",
                     .repeats = true,
                     .values = &options->parts}},
      .options = {{{"output", &options->output, "File to write: .exr"}, "FILE", 'o', Completion::file},
                  {{"keep-sums", &options->keep_sums, "Keep the exact sums, so that the file can be merged again"}}},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [options, &verbosity] { return run_merge(*options, verbosity); },
  };
  for (Option& option : verbosity_options(verbosity)) command.options.push_back(std::move(option));
  return command;
}

}  // namespace relume::cli

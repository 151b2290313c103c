#include "cli/render_plan.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "builtin_scenes/builtin.h"
#include "cli/image.h"
#include "cli/ocio_option.h"
#include "cli/video.h"
#include "files/extension.h"
#include "framebuffer/pixel_sums.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/sample_parts.h"
#include "render/session.h"
#include "render/stop_criteria.h"
#include "settings/text_list.h"

namespace relume::cli {
namespace {

/// One per frame; the same for all frames of a video.
std::vector<std::filesystem::path> files_of_sequence(const RenderOptions& options, const FrameRange& frames) {
  const bool video = is_video_file(options.output);
  if (video && !options.checkpoint.empty())
    throw UsageError("--resume cannot continue a video; render images (-o out.####.png) and encode them afterwards");
  const FrameNames name(options.output);
  std::vector<std::filesystem::path> files;
  for (int frame = frames.first; frame <= frames.last; ++frame)
    files.push_back(video ? std::filesystem::path(options.output) : name(frame));
  return files;
}

/// Throws UsageError if a file has two roles or an output cannot be written.
FileRoles roles_of(const RenderOptions& options, const std::vector<std::filesystem::path>& files) {
  FileRoles roles;
  roles.reads("SCENE", options.scene);
  roles.reads("--settings", options.settings_file);
  roles.reads("--ocio", ocio_config(options.ocio));
  for (const std::filesystem::path& file : files) {
    check_no_folder(file);
    roles.writes("-o", file);
  }
  roles.writes("--stats", options.stats);
  roles.writes("--resume", options.checkpoint);
  // The name of the last frame is the longest.
  for (const std::filesystem::path& file :
       {files.back(), std::filesystem::path(options.stats), std::filesystem::path(options.checkpoint)}) {
    if (!file.empty()) check_output_file(file);
  }
  return roles;
}

/// Four comma-separated numbers; an empty window for an empty text.
PixelWindow parse_window(std::string_view text, std::string_view place) {
  if (text.empty()) return {};
  std::vector<int> numbers;
  for (const std::string_view part : split_at_commas(text)) {
    int number = 0;
    const auto [end, failure] = std::from_chars(part.data(), part.data() + part.size(), number);
    if (failure == std::errc{} && end == part.data() + part.size() && number >= 0) numbers.push_back(number);
  }
  if (numbers.size() != 4 || std::count(text.begin(), text.end(), ',') != 3 || numbers[2] < 1 || numbers[3] < 1)
    throw UsageError(fmt::format(
        "{} is '{}', but must be left, top, width and height in pixels, such as 100,50,320,200", place, text));
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

/// Throws UsageError if the output holds radiance, to which no view applies.
void check_ocio_output(const RenderOptions& options) {
  const std::string extension = lower_extension(options.output);
  if (options.ocio.empty() || (extension != ".exr" && extension != ".hdr")) return;
  throw UsageError(fmt::format("{}: --ocio is for display images, but {} files store radiance; write a PNG",
                               options.output, extension));
}

/// The range of --sample-range. Throws UsageError if it is malformed or conflicts with other options.
std::optional<SampleRange> samples_of(const RenderOptions& options) {
  if (options.sample_range.empty()) return std::nullopt;
  const std::optional<SampleRange> range = parse_sample_range(options.sample_range);
  if (!range) {
    throw UsageError(
        fmt::format("--sample-range is '{}', but must be two numbers up to {} such as 0-127 or 128-255, the first a "
                    "multiple of {}",
                    options.sample_range, kLastSample, kBlockSamples));
  }
  if (!options.frames.empty())
    throw UsageError("--sample-range is for still images; render the frames of a sequence in parts with --frames");
  if (std::any_of(options.flags.begin(), options.flags.end(), [](const auto& flag) { return flag.first == "spp"; }))
    throw UsageError("--sample-range sets the number of samples; remove --spp");
  if (lower_extension(options.output) != ".exr")
    throw UsageError(
        fmt::format("{}: only .exr files can store the sums of --sample-range; write an .exr file", options.output));
  return range;
}

}  // namespace

std::vector<std::string> wanted_aovs(const RenderOptions& options, RenderSettings settings) {
  settings.auxiliary = true;
  return parse_aovs(options.aov, Session::aov_names(settings));
}

RenderPlan make_plan(const RenderOptions& options) {
  RenderPlan plan;
  if (options.output.empty()) throw UsageError("render needs -o FILE; see relume render --help");
  plan.files = {options.output};
  if (!options.frames.empty()) {
    plan.frames = parse_frame_range(options.frames, "--frames");
    plan.files = files_of_sequence(options, plan.frames);
  }
  plan.roles = roles_of(options, plan.files);
  plan.crop = parse_window(options.crop, "--crop");
  plan.samples = samples_of(options);
  check_ocio_output(options);
  plan.ocio = make_ocio_view(options.ocio, options.flags);
  if (plan.ocio) plan.roles.reads("--ocio", plan.ocio->files());
  plan.sources = {.preset = options.preset, .file = options.settings_file, .flags = options.flags};
  const RenderSettings settings = resolve(plan.sources).render;
  plan.threads = settings.threads;
  // The layers depend on the techniques, which for a scene file are known only once it is loaded.
  if (find_builtin_scene(options.scene)) plan.aovs = wanted_aovs(options, settings);
  std::vector<std::string> layers;
  if (!options.aov.empty()) layers.push_back(options.aov);
  if (is_video_file(options.output) && !options.frames.empty()) {
    check_video_file(options.output, layers);
  } else {
    check_image_file(options.output, layers);
  }
  return plan;
}

void plan_samples(const RenderPlan& plan, AllSettings& settings) {
  settings.render.auxiliary = !plan.aovs.empty();
  const std::string refused = sums_refusal(settings.render);
  settings.render.samples.sums = refused.empty();
  if (!plan.samples) return;
  if (!refused.empty()) throw UsageError(fmt::format("--sample-range cannot render a part: {}", refused));
  if (settings.stop.error > 0)
    throw UsageError(
        "--sample-range cannot render a part: its number of samples would depend on their values through --error, so "
        "merges would have biased weights; remove --error");
  settings.render.samples.part = true;
  settings.render.samples.first = plan.samples->first;
  settings.stop.spp = static_cast<int>(plan.samples->count());
}

void check_stop_settings(const AllSettings& settings) {
  const RenderLimits criteria = stop_criteria(settings.stop);
  const uint32_t pilot = pilot_samples(settings.render);
  if (criteria.samples > 0 && criteria.samples <= pilot) {
    throw UsageError(
        fmt::format("--adaptive.pilot excludes the samples of the first {} frames from the image; raise --spp or lower "
                    "--adaptive.max",
                    pilot));
  }
  if (settings.render.history != HistoryChoice::none || criteria.samples > 0 || criteria.time_s > 0) return;
  throw UsageError(
      "--error alone cannot stop a render with --history none, whose error is not known; give --spp or --time, or "
      "--history accumulate");
}

void check_earlier_images(const RenderPlan& plan, size_t first, const std::string& checkpoint) {
  const auto frame = [&](size_t index) { return plan.frames.first + static_cast<int>(index); };
  for (size_t i = 0; i < first; ++i) {
    if (std::error_code failure; std::filesystem::exists(plan.files[i], failure)) continue;
    throw Error(
        fmt::format("{}: the checkpoint is of frame {}, but frame {} ({}) is missing; delete the checkpoint to render "
                    "all, or use --frames {}-{}",
                    checkpoint, frame(first), frame(i), plan.files[i].string(), frame(first), plan.frames.last));
  }
}

}  // namespace relume::cli

// The plan of `relume render`, as far as known before the scene is loaded.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/file_roles.h"
#include "cli/frame_sequence.h"
#include "cli/render_job.h"
#include "framebuffer/ocio_view.h"
#include "parts/sample_ranges.h"
#include "render/settings.h"

namespace relume::cli {

/// The part of a render known before the scene is loaded. Making it detects most user errors.
struct RenderPlan {
  std::vector<std::string> aovs;  ///< for a scene file, known once it is loaded
  FrameRange frames;
  std::vector<std::filesystem::path> files;  ///< one per frame
  SettingSources sources;
  FileRoles roles;
  PixelWindow crop;                      ///< of --crop; empty: that of the scene's file, or the whole image
  std::shared_ptr<const OcioView> ocio;  ///< nullptr: the tone map
  std::optional<SampleRange> samples;    ///< of --sample-range; std::nullopt: all samples
  int threads = 0;
};

/// Throws UsageError or Error for impossible requests.
RenderPlan make_plan(const RenderOptions& options);

/// Names of the requested layers. Throws UsageError for an unknown layer, and Error for techniques that do not combine.
std::vector<std::string> wanted_aovs(const RenderOptions& options, RenderSettings settings);

/// Sets what follows from the plan: the layers and the range of samples. Images come from exact sums wherever the
/// techniques allow it, so that an image of a sequence equals the still image of its time. Throws UsageError if the
/// settings do not allow the plan's range of samples.
void plan_samples(const RenderPlan& plan, AllSettings& settings);

/// Throws UsageError for stop settings that never end (an error that stays unknown) or yield no image (a pilot alone).
void check_stop_settings(const AllSettings& settings);

/// Throws Error if an image before the `first` is missing: a checkpoint of another range would omit it.
void check_earlier_images(const RenderPlan& plan, size_t first, const std::string& checkpoint);

}  // namespace relume::cli

// What `relume render` is going to do, as far as that is known before the scene is loaded.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "file_roles.h"
#include "frame_sequence.h"
#include "framebuffer/ocio_view.h"
#include "render/settings.h"
#include "render_job.h"

namespace relume::cli {

/// What is known before the scene is loaded; making it finds most of the mistakes that a user can make.
struct RenderPlan {
  std::vector<std::string> aovs;  ///< of a scene file: once it is loaded
  FrameRange frames;
  std::vector<std::filesystem::path> files;  ///< one a frame
  SettingSources sources;
  FileRoles roles;
  PixelWindow crop;
  std::shared_ptr<const OcioView> ocio;  ///< nullptr: the tone map
  int threads = 0;
};

/// Throws UsageError or Error for what cannot be done.
RenderPlan make_plan(const RenderOptions& options);

/// Names of the layers that are asked for. Throws UsageError for a layer that there is not, and Error for techniques
/// that do not combine.
std::vector<std::string> wanted_aovs(const RenderOptions& options, RenderSettings settings);

/// Waiting for an error that never becomes known would not end, and a pilot alone is no image: throws UsageError.
void check_stop_settings(const AllSettings& settings);

}  // namespace relume::cli

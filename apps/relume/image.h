// Images as files: which formats there are, what goes into them, and how they say how they were made.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "render/display.h"
#include "render/settings.h"

namespace relume {
class OcioView;
class Session;
}  // namespace relume

namespace relume::cli {

/// check_output_file(), and throws UsageError unless the extension is one that images can be written to and the
/// format can hold `aovs` if there are any.
void check_image_file(const std::filesystem::path& file, const std::vector<std::string>& aovs);
/// Throws UsageError if layers are asked for in a file that has none.
void check_layers(const std::filesystem::path& file, const std::vector<std::string>& aovs);

/// "albedo,normal" in parts. Throws UsageError, with the names that exist, for one that is not in `known`.
std::vector<std::string> parse_aovs(std::string_view text, const std::vector<std::string>& known);

/// String attributes of EXR files; names begin with "relume.".
using Metadata = std::map<std::string, std::string>;

/// How an image of the session was made: program, scene, settings, seed, samples a pixel and render
/// seconds (those of Session::image_samples() and image_render_s()), and seconds of the stages before. Of
/// `settings`, those of `render` are the session's own. `load_s`: what reading the scene took.
Metadata image_metadata(const Session& session, const std::string& scene, AllSettings settings, double load_s);

/// The pixels of the window; all if it is empty.
Image part_of(const Image& image, const PixelWindow& window);
/// The session's image; with `--crop` the window that was rendered.
Image cropped_image(const Session& session);

/// The same exposed and as a display shows it: through `view`, or the display's tone map if that is nullptr.
Image displayed_image(const Session& session, const Display& display, const OcioView* view);

/// EXR: linear radiance with `aovs` as layers and `metadata`; HDR: linear radiance; other formats: displayed_image().
/// Throws Error.
void write_image(const std::filesystem::path& file, const Session& session, const Display& display,
                 const std::vector<std::string>& aovs, const Metadata& metadata, const OcioView* view = nullptr);

}  // namespace relume::cli

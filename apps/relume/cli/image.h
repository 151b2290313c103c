// Image files: formats, layers and metadata.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "relume/scene.h"
#include "render/display.h"
#include "render/settings.h"

namespace relume {
class OcioView;
class Session;
}  // namespace relume

namespace relume::cli {

/// Runs check_output_file(), and throws UsageError unless images can be written with this extension and the format can
/// hold `aovs`.
void check_image_file(const std::filesystem::path& file, const std::vector<std::string>& aovs);
/// Throws UsageError if layers are requested for a file format without layers.
void check_layers(const std::filesystem::path& file, const std::vector<std::string>& aovs);

/// Splits "albedo,normal". Throws UsageError, listing the existing names, for one that is not in `known`.
std::vector<std::string> parse_aovs(std::string_view text, const std::vector<std::string>& known);

/// String attributes of EXR files; names begin with "relume.".
using Metadata = std::map<std::string, std::string>;

/// Provenance of the session's image: program, scene, settings, seed, samples per pixel, render seconds (those of
/// Session::image_samples() and image_render_s()), and seconds of the earlier stages. In `settings`, the session's own
/// replace those of `render`. `load_s`: seconds to read the scene.
Metadata image_metadata(const Session& session, const std::string& scene, AllSettings settings, double load_s);

/// Pixels of a part of an image of this size; empty: all of them.
PixelWindow pixels_of(const ImagePart& part, int width, int height);
/// The pixels of the window; all if it is empty.
Image part_of(const Image& image, const PixelWindow& window);
/// The session's image; with `--crop` the rendered window.
Image cropped_image(const Session& session);

/// The same, exposed and display-encoded through `view`, or the display's tone map if that is nullptr.
Image displayed_image(const Session& session, const Display& display, const OcioView* view);

/// EXR: linear radiance with `aovs` as layers and `metadata`; HDR: linear radiance; other formats: displayed_image().
/// Throws Error.
void write_image(const std::filesystem::path& file, const Session& session, const Display& display,
                 const std::vector<std::string>& aovs, const Metadata& metadata, const OcioView* view = nullptr);

}  // namespace relume::cli

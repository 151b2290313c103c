#include "framebuffer/ocio_view.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "core/parallel.h"
#include "core/srgb.h"
#include "relume/error.h"

#if defined(RELUME_WITH_OCIO)
#include <OpenColorIO/OpenColorIO.h>
#endif

namespace relume {

#if defined(RELUME_WITH_OCIO)

namespace ocio = OCIO_NAMESPACE;

struct OcioView::State {
  ocio::ConstCPUProcessorRcPtr processor;
};

namespace {

/// Linear Rec. 709 colour space of a configuration: tries the names of ACES, Blender, Filmic and OpenColorIO's built-in
/// configurations. `note` describes a replacement.
std::string linear_rec709(const ocio::ConstConfigRcPtr& config, const std::string& file, std::string& note) {
  for (const char* name : {"lin_rec709_srgb", "Linear Rec.709 (sRGB)", "lin_rec709", "Linear Rec.709",
                           "Utility - Linear - sRGB", "lin_srgb", "Linear sRGB", "Linear BT.709"}) {
    if (config->getColorSpace(name)) return name;
  }
  if (const ocio::ConstColorSpaceRcPtr space = config->getColorSpace(ocio::ROLE_SCENE_LINEAR)) {
    note = fmt::format(
        "{} has no linear Rec. 709 colour space; radiance is interpreted as its role scene_linear, which is '{}'", file,
        space->getName());
    return ocio::ROLE_SCENE_LINEAR;
  }
  throw Error("it has neither a linear Rec. 709 colour space nor the role scene_linear; add one of them");
}

/// Display of the view. Throws Error.
std::string display_of(const ocio::ConstConfigRcPtr& config, const std::string& view) {
  std::vector<std::string> views;
  for (int d = 0; d < config->getNumDisplays(); ++d) {
    const char* display = config->getDisplay(d);
    for (int v = 0; v < config->getNumViews(display); ++v) {
      views.emplace_back(config->getView(display, v));
      if (views.back() == view) return display;
    }
  }
  std::sort(views.begin(), views.end());
  views.erase(std::unique(views.begin(), views.end()), views.end());
  throw Error(fmt::format("it has no view '{}'; it has {}", view, fmt::join(views, ", ")));
}

/// The library's message, formatted as part of a sentence.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text;
}

ocio::ConstProcessorRcPtr processor_for(const std::string& file, const std::string& view, std::string& note) {
  const ocio::ConstConfigRcPtr config = ocio::Config::CreateFromFile(file.c_str());
  const ocio::DisplayViewTransformRcPtr transform = ocio::DisplayViewTransform::Create();
  transform->setSrc(linear_rec709(config, file, note).c_str());
  transform->setDisplay(display_of(config, view).c_str());
  transform->setView(view.c_str());
  return config->getProcessor(transform);
}

std::vector<std::filesystem::path> files_of(const ocio::Processor& processor) {
  const ocio::ConstProcessorMetadataRcPtr metadata = processor.getProcessorMetadata();
  std::vector<std::filesystem::path> files;
  for (int i = 0; i < metadata->getNumFiles(); ++i) files.emplace_back(metadata->getFile(i));
  return files;
}

}  // namespace

std::string ocio_missing() { return {}; }

OcioView::OcioView(const std::string& file, const std::string& view) {
  try {
    const ocio::ConstProcessorRcPtr processor = processor_for(file, view, note_);
    state_ = std::make_unique<const State>(State{processor->getDefaultCPUProcessor()});
    files_ = files_of(*processor);
  } catch (const std::exception& error) {
    throw Error(fmt::format("{}: the OpenColorIO configuration cannot be used: {}", file, one_line(error.what())));
  }
}

Image OcioView::encode(const Image& radiance, float exposure) const {
  const float scale = std::exp2(exposure);
  Image image(radiance.width, radiance.height);
  const auto width = static_cast<size_t>(radiance.width);
  parallel_for(static_cast<size_t>(radiance.height), [&](size_t y) {
    Rgb* row = image.pixels.data() + y * width;
    for (size_t x = 0; x < width; ++x) {
      const Rgb scaled = radiance.pixels[y * width + x] * scale;
      for (int c = 0; c < 3; ++c) row[x][c] = is_finite(scaled[c]) ? scaled[c] : 0.0f;
    }
    ocio::PackedImageDesc pixels(row, radiance.width, 1, 3);
    state_->processor->apply(pixels);
    for (size_t x = 0; x < width; ++x) row[x] = glm::clamp(row[x], Rgb(0), Rgb(1));
  });
  return image;
}

#else

struct OcioView::State {};

std::string ocio_missing() {
  return "--ocio needs OpenColorIO, which was not found when relume was built; install libopencolorio-dev and build "
         "again, or use --tone-map";
}

OcioView::OcioView(const std::string&, const std::string&) { throw Error(ErrorCode::not_supported, ocio_missing()); }

Image OcioView::encode(const Image& radiance, float) const { return radiance; }

#endif

Image OcioView::apply(const Image& radiance, float exposure) const {
  Image image = encode(radiance, exposure);
  parallel_for(image.pixels.size(), [&](size_t i) { image.pixels[i] = linear_from_srgb(image.pixels[i]); });
  return image;
}

OcioView::~OcioView() = default;
OcioView::OcioView(OcioView&&) noexcept = default;

}  // namespace relume

#include "render/aov.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "framebuffer/pixel_moments.h"
#include "relume/error.h"
#include "render/summed_layers.h"
#include "settings/nearest_name.h"

namespace relume {
namespace {

std::string_view channel_letters(const BufferDescription& b) {
  if (!b.channels.empty()) return b.channels;
  if (b.id.type == BufferType::rgb32f) return "RGB";
  return b.id.type == BufferType::vec2f ? "XY" : "Y";
}

/// Component `c` of all elements, times `scale`.
std::vector<float> components(const Buffer& buffer, size_t count, int c, float scale) {
  std::vector<float> values(count);
  const auto copy = [&](const auto& elements, const auto& component) {
    for (size_t i = 0; i < count; ++i) values[i] = component(elements[static_cast<uint32_t>(i)]) * scale;
  };
  switch (buffer.description().id.type) {
    case BufferType::f32: copy(buffer.read<float>(), [](float v) { return v; }); break;
    case BufferType::rgb32f: copy(buffer.read<Rgb>(), [c](const Rgb& v) { return v[c]; }); break;
    case BufferType::vec2f: copy(buffer.read<Vec2>(), [c](const Vec2& v) { return v[c]; }); break;
    case BufferType::u32: copy(buffer.read<uint32_t>(), [](uint32_t v) { return static_cast<float>(v); }); break;
    case BufferType::record: break;
  }
  return values;
}

std::vector<ExrChannel> variance_planes(const BufferTable& buffers, uint32_t correlated_frames) {
  const auto m2 = buffers.read(kMoments.m2);
  const auto count = buffers.read(kSamples);
  ExrChannel plane{"variance.Y", std::vector<float>(m2.size)};
  for (uint32_t i = 0; i < m2.size; ++i) plane.values[i] = variance_of_mean(m2[i], count[i], correlated_frames);
  return {plane};
}

std::vector<std::string> displayed_names(const BufferTable& buffers) {
  std::vector<std::string> names{"variance"};
  for (const auto& buffer : buffers.all()) {
    const BufferDescription& b = buffer->description();
    if (b.display != BufferDisplay::hidden) names.emplace_back(b.id.name);
  }
  return names;
}

}  // namespace

std::vector<AovLayer> aov_layers(const std::vector<PassDeclaration>& passes) {
  std::vector<AovLayer> layers{{"variance", "variance of the pixel's mean luminance"}};
  for (const PassDeclaration& pass : passes) {
    for (const BufferDescription& b : pass.owns) {
      if (b.display != BufferDisplay::hidden) layers.push_back({std::string(b.id.name), b.help});
    }
  }
  std::sort(layers.begin(), layers.end(), [](const AovLayer& a, const AovLayer& b) { return a.name < b.name; });
  return layers;
}

std::vector<std::string> names_of(const std::vector<AovLayer>& layers) {
  std::vector<std::string> names;
  for (const AovLayer& layer : layers) names.push_back(layer.name);
  return names;
}

std::vector<ExrChannel> aov_planes(const BufferTable& buffers, const std::string& name, uint32_t frames,
                                   uint32_t correlated_frames) {
  if (has_sums(buffers)) {
    std::vector<ExrChannel> summed = summed_planes(buffers, name, frames, correlated_frames);
    if (!summed.empty()) return summed;
  }
  if (name == "variance") return variance_planes(buffers, correlated_frames);
  const Buffer* buffer = buffers.find(name);
  if (!buffer || buffer->description().display == BufferDisplay::hidden) {
    throw Error(ErrorCode::not_found, fmt::format("there is no AOV '{}' with these settings{}", name,
                                                  suggestion(name, displayed_names(buffers))));
  }
  const BufferDescription& description = buffer->description();
  const size_t count = size_t{buffers.width()} * buffers.height();
  const bool is_mean = description.display == BufferDisplay::mean;
  const float scale = is_mean && frames > 0 ? 1.0f / static_cast<float>(frames) : 1.0f;
  std::vector<ExrChannel> planes;
  const std::string_view letters = channel_letters(description);
  for (size_t c = 0; c < letters.size(); ++c) {
    planes.push_back({fmt::format("{}.{}", name, letters[c]), components(*buffer, count, static_cast<int>(c), scale)});
  }
  return planes;
}

}  // namespace relume

#include "render/aov.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "framebuffer/pixel_moments.h"
#include "relume/error.h"
#include "settings/nearest_name.h"

namespace relume {
namespace {

std::string_view channel_letters(const BufferDescription& b) {
  if (!b.channels.empty()) return b.channels;
  if (b.id.type == BufferType::rgb32f) return "RGB";
  return b.id.type == BufferType::vec2f ? "XY" : "Y";
}

/// Component `c` of element `i`.
float component(const Buffer& buffer, uint32_t i, int c) {
  switch (buffer.description().id.type) {
    case BufferType::f32: return buffer.view<const float>()[i];
    case BufferType::rgb32f: return buffer.view<const Rgb>()[i][c];
    case BufferType::vec2f: return buffer.view<const Vec2>()[i][c];
    case BufferType::u32: return static_cast<float>(buffer.view<const uint32_t>()[i]);
    case BufferType::record: return 0.0f;
  }
  return 0.0f;
}

std::vector<ExrChannel> variance_planes(const BufferTable& buffers) {
  const auto m2 = buffers.view(kMoments.m2);
  const auto count = buffers.view(kSamples);
  ExrChannel plane{"variance.Y", std::vector<float>(m2.size)};
  for (uint32_t i = 0; i < m2.size; ++i) plane.values[i] = variance_of_mean(m2[i], count[i]);
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

std::vector<ExrChannel> aov_planes(const BufferTable& buffers, const std::string& name, uint32_t frames) {
  if (name == "variance") return variance_planes(buffers);
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
    ExrChannel plane{fmt::format("{}.{}", name, letters[c]), std::vector<float>(count)};
    for (size_t i = 0; i < count; ++i)
      plane.values[i] = component(*buffer, static_cast<uint32_t>(i), static_cast<int>(c)) * scale;
    planes.push_back(std::move(plane));
  }
  return planes;
}

}  // namespace relume

#include "render/summed_layers.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/parallel.h"
#include "framebuffer/shared_buffers.h"
#include "techniques/temporal/accumulate/sample_sums_pass.h"

namespace relume {
namespace {

struct Channel {
  std::string_view name;
  SummedValue value;
};

constexpr std::array kChannels = {
    Channel{"R", SummedValue::r},
    Channel{"G", SummedValue::g},
    Channel{"B", SummedValue::b},
    Channel{"variance.Y", SummedValue::variance},
    Channel{"albedo.R", SummedValue::albedo_r},
    Channel{"albedo.G", SummedValue::albedo_g},
    Channel{"albedo.B", SummedValue::albedo_b},
    Channel{"normal.X", SummedValue::normal_x},
    Channel{"normal.Y", SummedValue::normal_y},
    Channel{"normal.Z", SummedValue::normal_z},
    Channel{"depth.Z", SummedValue::depth},
    Channel{"samples.Y", SummedValue::samples},
    Channel{"heatmap.Y", SummedValue::rays},
    Channel{"nonfinite.Y", SummedValue::nonfinite},
};

/// Layers that differ from those of the buffers, whose sums depend on the order of samples.
constexpr std::array<std::string_view, 4> kSummedLayers = {"variance", "albedo", "normal", "depth"};

RadianceSums with_block(RadianceSums sums, const SampleBlock& block) {
  sums.add(block);
  return sums;
}

}  // namespace

std::optional<SummedValue> summed_value(std::string_view channel) {
  const auto* const found =
      std::find_if(kChannels.begin(), kChannels.end(), [&](const Channel& c) { return c.name == channel; });
  return found == kChannels.end() ? std::nullopt : std::optional(found->value);
}

float value_of(SummedValue value, const PixelSums& sums, uint32_t samples, uint32_t correlated_frames) {
  switch (value) {
    case SummedValue::r: return sums.radiance.mean(samples).r;
    case SummedValue::g: return sums.radiance.mean(samples).g;
    case SummedValue::b: return sums.radiance.mean(samples).b;
    case SummedValue::variance: return sums.radiance.variance(samples, correlated_frames);
    case SummedValue::albedo_r: return mean_of(sums.surface.albedo[0], samples);
    case SummedValue::albedo_g: return mean_of(sums.surface.albedo[1], samples);
    case SummedValue::albedo_b: return mean_of(sums.surface.albedo[2], samples);
    case SummedValue::normal_x: return mean_of(sums.surface.normal[0], samples);
    case SummedValue::normal_y: return mean_of(sums.surface.normal[1], samples);
    case SummedValue::normal_z: return mean_of(sums.surface.normal[2], samples);
    case SummedValue::depth: return mean_of(sums.surface.depth, samples);
    case SummedValue::samples: return static_cast<float>(samples);
    case SummedValue::rays:  // as aov_planes()
      return static_cast<float>(sums.rays) * (samples > 0 ? 1.0f / static_cast<float>(samples) : 1.0f);
    case SummedValue::nonfinite: return static_cast<float>(sums.nonfinite);
  }
  return 0;
}

bool has_sums(const BufferTable& buffers) { return buffers.find(kRadianceSums.name) != nullptr; }

void read_sums(const BufferTable& buffers, uint32_t first_pixel, std::span<PixelSums> sums) {
  const View<const RadianceSums> radiance = buffers.read(kRadianceSums);
  const View<const SampleBlock> blocks = buffers.read(kSampleBlock);
  const View<const SurfaceSums> surface = buffers.read(kSurfaceSums);
  const View<const uint32_t> rays = buffers.read(BufferKey<uint32_t>{"heatmap"});
  const View<const uint32_t> nonfinite = buffers.read(kNonfinite);
  for (size_t i = 0; i < sums.size(); ++i) {
    const uint32_t pixel = first_pixel + static_cast<uint32_t>(i);
    sums[i].radiance = with_block(radiance[pixel], blocks[pixel]);
    sums[i].rays = rays[pixel];
    sums[i].nonfinite = nonfinite[pixel];
    if (!surface.empty()) sums[i].surface = surface[pixel];
  }
}

std::vector<Rgb> summed_image(const BufferTable& buffers, uint32_t samples) {
  const View<const RadianceSums> sums = buffers.read(kRadianceSums);
  const View<const SampleBlock> blocks = buffers.read(kSampleBlock);
  std::vector<Rgb> image(sums.size);
  const uint32_t width = buffers.width();
  parallel_for(buffers.height(), [&](size_t y) {
    const auto first = static_cast<uint32_t>(y) * width;
    for (uint32_t i = first; i < first + width; ++i) image[i] = with_block(sums[i], blocks[i]).mean(samples);
  });
  return image;
}

std::vector<ExrChannel> summed_planes(const BufferTable& buffers, std::string_view layer, uint32_t samples,
                                      uint32_t correlated_frames) {
  std::vector<ExrChannel> planes;
  if (std::find(kSummedLayers.begin(), kSummedLayers.end(), layer) == kSummedLayers.end()) return planes;
  if (layer != "variance" && buffers.find(kSurfaceSums.name) == nullptr) return planes;
  const size_t pixels = size_t{buffers.width()} * buffers.height();
  std::vector<SummedValue> values;
  for (const Channel& channel : kChannels) {
    if (!channel.name.starts_with(layer) || channel.name.substr(layer.size()).front() != '.') continue;
    planes.push_back({std::string(channel.name), std::vector<float>(pixels)});
    values.push_back(channel.value);
  }
  std::vector<PixelSums> row(buffers.width());
  for (size_t begin = 0; begin < pixels; begin += row.size()) {
    read_sums(buffers, static_cast<uint32_t>(begin), row);
    for (size_t p = 0; p < planes.size(); ++p) {
      for (size_t x = 0; x < row.size(); ++x)
        planes[p].values[begin + x] = value_of(values[p], row[x], samples, correlated_frames);
    }
  }
  return planes;
}

}  // namespace relume

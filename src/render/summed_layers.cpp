#include "render/summed_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

/// The sums of a session's pixels, with the samples of an incomplete block.
class SumsView {
 public:
  explicit SumsView(const BufferTable& buffers)
      : radiance_(buffers.read(kRadianceSums)),
        blocks_(buffers.read(kSampleBlock)),
        surface_(buffers.read(kSurfaceSums)),
        rays_(buffers.read(BufferKey<uint32_t>{"heatmap"})),
        nonfinite_(buffers.read(kNonfinite)) {}

  PixelSums of(uint32_t pixel) const {
    PixelSums sums;
    sums.radiance = with_block(radiance_[pixel], blocks_[pixel]);
    sums.rays = rays_[pixel];
    sums.nonfinite = nonfinite_[pixel];
    if (!surface_.empty()) sums.surface = surface_[pixel];
    return sums;
  }

 private:
  View<const RadianceSums> radiance_;
  View<const SampleBlock> blocks_;
  View<const SurfaceSums> surface_;
  View<const uint32_t> rays_;
  View<const uint32_t> nonfinite_;
};

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
  const SumsView view(buffers);
  for (size_t i = 0; i < sums.size(); ++i) sums[i] = view.of(first_pixel + static_cast<uint32_t>(i));
}

void add_sums(const BufferTable& buffers, std::span<PixelSums> sums) {
  const SumsView view(buffers);
  const uint32_t width = buffers.width();
  parallel_for(buffers.height(), [&](size_t y) {
    const auto first = static_cast<uint32_t>(y) * width;
    for (uint32_t i = first; i < first + width; ++i) sums[i].add(view.of(i));
  });
}

double relative_error(std::span<const PixelSums> sums, const SummedImage& image) {
  if (image.samples < 2) return std::numeric_limits<double>::infinity();
  struct Row {
    double variance = 0;
    double luminance = 0;
  };
  const PixelWindow& w = image.window;
  std::vector<Row> rows(static_cast<size_t>(w.height));
  parallel_for(rows.size(), [&](size_t y) {
    const size_t first = (static_cast<size_t>(w.y) + y) * image.width + static_cast<size_t>(w.x);
    for (const PixelSums& pixel : sums.subspan(first, static_cast<size_t>(w.width))) {
      rows[y].variance += static_cast<double>(pixel.radiance.variance(image.samples, image.correlated_frames));
      rows[y].luminance += static_cast<double>(luminance(pixel.radiance.mean(image.samples)));
    }
  });
  Row all;
  for (const Row& row : rows) {
    all.variance += row.variance;
    all.luminance += row.luminance;
  }
  const double pixels = static_cast<double>(w.width) * static_cast<double>(w.height);
  if (all.luminance <= 0) return 0;
  return std::sqrt(all.variance / pixels) / (all.luminance / pixels);
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

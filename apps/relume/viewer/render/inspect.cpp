#include "viewer/render/inspect.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "render/build_pipeline.h"
#include "viewer/render/frame_pixels.h"

namespace relume::viewer {
namespace {

std::string number(float x) { return std::isnan(x) ? "nan" : fmt::format("{:.5g}", x); }

}  // namespace

std::vector<AovLayer> inspectable_buffers(const RenderSettings& settings) {
  RenderSettings all = settings;
  all.auxiliary = true;
  return aov_layers(plan(all));
}

bool needs_auxiliary(const RenderSettings& settings, const std::string& buffer) {
  RenderSettings without = settings;
  without.auxiliary = false;
  const std::vector<std::string> names = Session::aov_names(without);
  return !buffer.empty() && std::find(names.begin(), names.end(), buffer) == names.end();
}

Vec2 value_range(const std::vector<Rgb>& values, size_t channels) {
  constexpr size_t kMost = 8192;
  const size_t step = std::max<size_t>(1, values.size() / kMost);
  std::vector<float> sample;
  for (size_t i = 0; i < values.size(); i += step) {
    for (size_t c = 0; c < channels; ++c) {
      const float value = values[i][static_cast<int>(c)];
      if (is_finite(value)) sample.push_back(value);
    }
  }
  if (sample.empty()) return {0, 1};
  const auto percentile = [&](double share) {
    const auto at = sample.begin() + std::lround(share * static_cast<double>(sample.size() - 1));
    std::nth_element(sample.begin(), at, sample.end());
    return *at;
  };
  const Vec2 range(percentile(0.01), percentile(0.99));
  if (range.y > range.x) return range;
  return range.x > 0 ? Vec2(0, range.x) : Vec2(range.x, range.x + 1);
}

void read_buffer(const Session& session, const std::string& name, ViewerFrame& frame) {
  if (name.empty()) return;
  const std::vector<std::string> known = names_of(aov_layers(pass_declarations(session)));
  if (std::find(known.begin(), known.end(), name) == known.end()) return;
  const std::vector<ExrChannel> planes = session.aov(name);
  const size_t channels = std::min<size_t>(planes.size(), 3);
  frame.buffer = name;
  frame.values.assign(frame.radiance.size(), Rgb(0));
  for (size_t c = 0; c < channels; ++c) {
    frame.channels += planes[c].name.back();
    for (size_t i = 0; i < frame.values.size(); ++i) frame.values[i][static_cast<int>(c)] = planes[c].values[i];
  }
  frame.value_range = value_range(frame.values, channels);
}

std::string describe_pixel(const ViewerFrame& frame, const Vec2& point) {
  const int x = std::clamp(static_cast<int>(point.x * static_cast<float>(frame.width)), 0, frame.width - 1);
  const int y = std::clamp(static_cast<int>(point.y * static_cast<float>(frame.height)), 0, frame.height - 1);
  const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(frame.width) + static_cast<size_t>(x);
  const Rgb c = radiance_at(frame, pixel);
  std::string text = fmt::format("({}, {})  RGB {} {} {}", x, y, number(c.r), number(c.g), number(c.b));
  if (frame.values.empty()) return text;
  text += "  \xc2\xb7  " + frame.buffer;
  for (size_t i = 0; i < frame.channels.size(); ++i) {
    const std::string channel = frame.channels.size() == 1 ? "" : std::string(1, frame.channels[i]) + " ";
    text += " " + channel + number(frame.values[pixel][static_cast<int>(i)]);
  }
  return text;
}

}  // namespace relume::viewer

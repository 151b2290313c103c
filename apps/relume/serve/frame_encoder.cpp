#include "serve/frame_encoder.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <turbojpeg.h>

#include "cli/console.h"
#include "relume/error.h"
#include "relume/image_io.h"
#include "viewer/render/develop.h"

namespace relume::serve {
namespace {

using viewer::ViewerFrame;

constexpr size_t kChannels = 3;

/// Colours of one side.
Colors developed(const ViewerFrame& frame, const viewer::DisplayTransform& transform,
                 const viewer::DisplayTable& table) {
  const std::vector<Rgb>& values = frame.values.empty() ? frame.radiance : frame.values;
  Colors colors{frame.width, frame.height, std::vector<uint8_t>(kChannels * values.size())};
  viewer::develop(values, transform, table, colors.rgb);
  return colors;
}

/// Replaces the columns from `split_at` on by those of B, which may have another size.
void merge(Colors& a, const Colors& b, float split_at) {
  const int first = std::clamp(static_cast<int>(split_at * static_cast<float>(a.width)), 0, a.width);
  for (int y = 0; y < a.height; ++y) {
    const int from_y = y * b.height / a.height;
    for (int x = first; x < a.width; ++x) {
      const int from_x = x * b.width / a.width;
      const size_t from =
          kChannels * (static_cast<size_t>(from_y) * static_cast<size_t>(b.width) + static_cast<size_t>(from_x));
      const size_t to = kChannels * (static_cast<size_t>(y) * static_cast<size_t>(a.width) + static_cast<size_t>(x));
      std::copy_n(b.rgb.begin() + static_cast<std::ptrdiff_t>(from), kChannels,
                  a.rgb.begin() + static_cast<std::ptrdiff_t>(to));
    }
  }
}

/// Mean of a block of one channel.
uint8_t block_mean(const Colors& colors, int x0, int y0, int divisor, size_t channel) {
  const int x1 = std::min(x0 + divisor, colors.width);
  const int y1 = std::min(y0 + divisor, colors.height);
  int sum = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) sum += colors.rgb[kChannels * static_cast<size_t>(y * colors.width + x) + channel];
  }
  const int count = (x1 - x0) * (y1 - y0);
  return static_cast<uint8_t>((sum + count / 2) / count);
}

}  // namespace

Colors shrunk(const Colors& colors, int divisor) {
  Colors result{(colors.width + divisor - 1) / divisor, (colors.height + divisor - 1) / divisor, {}};
  result.rgb.reserve(kChannels * static_cast<size_t>(result.width) * static_cast<size_t>(result.height));
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      for (size_t c = 0; c < kChannels; ++c)
        result.rgb.push_back(block_mean(colors, x * divisor, y * divisor, divisor, c));
    }
  }
  return result;
}

std::vector<uint8_t> encode_jpeg(const Colors& colors, int quality) {
  const std::unique_ptr<void, int (*)(void*)> compressor(tjInitCompress(), tjDestroy);
  if (!compressor) throw Error("the JPEG compressor cannot start: out of memory");
  constexpr int kSampling = TJSAMP_420;
  std::vector<uint8_t> bytes(tjBufSize(colors.width, colors.height, kSampling));
  unsigned char* to = bytes.data();
  unsigned long size = bytes.size();
  const int failed = tjCompress2(compressor.get(), colors.rgb.data(), colors.width, 0, colors.height, TJPF_RGB, &to,
                                 &size, kSampling, quality, TJFLAG_NOREALLOC | TJFLAG_FASTDCT);
  if (failed != 0) throw Error(fmt::format("a frame cannot be compressed: {}", tjGetErrorStr2(compressor.get())));
  bytes.resize(size);
  bytes.shrink_to_fit();
  return bytes;
}

FrameEncoder::FrameEncoder(Done done)
    : done_(std::move(done)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

FrameEncoder::~FrameEncoder() {
  thread_.request_stop();
  thread_.join();
}

void FrameEncoder::request(std::shared_ptr<const ShownImage> image, int level) {
  const std::lock_guard lock(mutex_);
  image_ = std::move(image);
  wanted_[static_cast<size_t>(level)] = true;
  wake_.notify_one();
}

void FrameEncoder::run(const std::stop_token& stop) {
  while (true) {
    std::unique_lock lock(mutex_);
    const auto due = [this] { return std::find(wanted_.begin(), wanted_.end(), true) != wanted_.end(); };
    if (!wake_.wait(lock, stop, due)) return;
    const std::shared_ptr<const ShownImage> image = image_;
    const auto wanted = std::exchange(wanted_, {});
    lock.unlock();
    try {
      develop(*image);
      for (size_t level = 0; level < wanted.size(); ++level) {
        if (stop.stop_requested()) return;
        if (wanted[level]) done_(encode(*image, static_cast<int>(level)));
      }
    } catch (const std::exception& error) {
      cli::warn(error.what());
      for (size_t level = 0; level < wanted.size(); ++level) {
        if (wanted[level]) done_(nullptr);  // viewers may ask for the next one
      }
    }
  }
}

const viewer::DisplayTable& FrameEncoder::table_of(const viewer::DisplayTransform& transform) {
  if (transform.table != nullptr) return *transform.table;
  if (tone_map_ != transform.tone_map) {
    tone_table_ = viewer::display_table(transform.tone_map);
    tone_map_ = transform.tone_map;
  }
  return tone_table_;
}

void FrameEncoder::develop(const ShownImage& image) {
  if (developed_ == image.version) return;
  colors_ = developed(*image.frames[0], image.transforms[0], table_of(image.transforms[0]));
  if (image.frames[1] && image.split_at < 1) {
    const Colors second = developed(*image.frames[1], image.transforms[1], table_of(image.transforms[1]));
    merge(colors_, second, image.split_at);
  }
  developed_ = image.version;
}

std::shared_ptr<const EncodedImage> FrameEncoder::encode(const ShownImage& image, int level) const {
  auto encoded = std::make_shared<EncodedImage>();
  encoded->version = image.version;
  encoded->level = level;
  encoded->viewer = image.viewer;
  encoded->input = image.input;
  encoded->width = colors_.width;
  encoded->height = colors_.height;
  if (level == kPngLevel) {
    encoded->bytes = encode_png(colors_.rgb, colors_.width, colors_.height);
    return encoded;
  }
  const FrameLevel& choice = kLevels[static_cast<size_t>(level)];
  encoded->bytes = encode_jpeg(choice.divisor == 1 ? colors_ : shrunk(colors_, choice.divisor), choice.quality);
  return encoded;
}

}  // namespace relume::serve

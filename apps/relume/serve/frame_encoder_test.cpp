#include "serve/frame_encoder.h"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "relume/image_io.h"

namespace relume::serve {
namespace {

Image decoded(const std::vector<uint8_t>& bytes) { return parse_image(std::as_bytes(std::span(bytes)), "frame"); }

Colors gradient(int width, int height) {
  Colors colors{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      colors.rgb.push_back(static_cast<uint8_t>(255 * x / width));
      colors.rgb.push_back(static_cast<uint8_t>(255 * y / height));
      colors.rgb.push_back(64);
    }
  }
  return colors;
}

std::shared_ptr<const viewer::ViewerFrame> frame_of(int width, int height, const Rgb& value) {
  auto frame = std::make_shared<viewer::ViewerFrame>();
  frame->width = width;
  frame->height = height;
  frame->radiance.assign(static_cast<size_t>(width * height), value);
  return frame;
}

/// Collects what an encoder has done.
struct Results {
  std::mutex mutex;
  std::condition_variable arrived;
  std::deque<std::shared_ptr<const EncodedImage>> images;

  void add(std::shared_ptr<const EncodedImage> shown) {
    const std::lock_guard lock(mutex);
    images.push_back(std::move(shown));
    arrived.notify_one();
  }
  std::shared_ptr<const EncodedImage> next() {
    std::unique_lock lock(mutex);
    if (!arrived.wait_for(lock, std::chrono::seconds(60), [this] { return !images.empty(); })) return nullptr;
    std::shared_ptr<const EncodedImage> first = images.front();
    images.pop_front();
    return first;
  }
};

TEST(FrameEncoder, ShrinksByMeansOfBlocks) {
  const Colors colors{3, 3, {10, 0, 0, 20, 0, 0, 9, 0, 0, 30, 0, 0, 40, 0, 0, 9, 0, 0, 5, 0, 0, 7, 0, 0, 100, 0, 0}};
  const Colors small = shrunk(colors, 2);
  EXPECT_EQ(small.width, 2);
  EXPECT_EQ(small.height, 2);
  EXPECT_EQ(small.rgb, (std::vector<uint8_t>{25, 0, 0, 9, 0, 0, 6, 0, 0, 100, 0, 0}));
}

TEST(FrameEncoder, JpegShowsTheImage) {
  const Colors colors = gradient(64, 48);
  const Image image = decoded(encode_jpeg(colors, 92));
  ASSERT_EQ(image.width, 64);
  ASSERT_EQ(image.height, 48);
  EXPECT_GT(image.at(60, 10).r, image.at(4, 10).r + 0.5f);
  EXPECT_GT(image.at(30, 44).g, image.at(30, 4).g + 0.4f);
  EXPECT_LT(encode_jpeg(colors, 25).size(), encode_jpeg(colors, 92).size());
}

TEST(FrameEncoder, EncodesTheNewestImageAtTheRequestedLevels) {
  Results results;
  FrameEncoder encoder([&](std::shared_ptr<const EncodedImage> shown) { results.add(std::move(shown)); });
  auto shown = std::make_shared<ShownImage>();
  shown->version = 1;
  shown->viewer = 3;
  shown->input = 9;
  shown->frames[0] = frame_of(40, 20, Rgb(0.2f));
  encoder.request(shown, 4);
  const auto small = results.next();
  ASSERT_TRUE(small);
  EXPECT_EQ(small->version, 1u);
  EXPECT_EQ(small->level, 4);
  EXPECT_EQ(small->viewer, 3u);
  EXPECT_EQ(small->input, 9u);
  EXPECT_EQ(small->width, 40);
  EXPECT_EQ(decoded(small->bytes).width, 40 / kLevels[4].divisor);
  encoder.request(shown, kPngLevel);
  const auto png = results.next();
  ASSERT_TRUE(png);
  EXPECT_EQ(decoded(png->bytes).width, 40);
}

TEST(FrameEncoder, SideBIsToTheRightOfTheLine) {
  Results results;
  FrameEncoder encoder([&](std::shared_ptr<const EncodedImage> shown) { results.add(std::move(shown)); });
  auto shown = std::make_shared<ShownImage>();
  shown->version = 1;
  shown->frames[0] = frame_of(40, 20, Rgb(0));
  shown->frames[1] = frame_of(20, 10, Rgb(4));  // may have another size
  shown->split_at = 0.25f;
  encoder.request(shown, kPngLevel);
  const auto png = results.next();
  ASSERT_TRUE(png);
  const Image image = decoded(png->bytes);
  EXPECT_LT(image.at(9, 10).g, 0.05f);
  EXPECT_GT(image.at(10, 10).g, 0.5f);
}

}  // namespace
}  // namespace relume::serve

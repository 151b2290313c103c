// Which frames of a GPU reach the window by a texture, with a display that records what it is asked for.
#include "viewer/render/frame_texture.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "viewer/render/frame_pixels.h"
#include "viewer/render/inspect.h"

namespace relume::viewer {
namespace {

/// What a display was asked for, and what it refuses.
struct Record {
  std::string events;
  bool refuses_to_share = false;
  bool refuses_to_write = false;
};

class FakeTexture final : public DeviceTexture {
 public:
  explicit FakeTexture(Record& record) : record_(record) {}
  ~FakeTexture() override { record_.events += "close "; }
  bool write(DeviceImage&) override {
    record_.events += "write ";
    return !record_.refuses_to_write;
  }

 private:
  Record& record_;
};

class FakeDisplay final : public DeviceDisplay {
 public:
  explicit FakeDisplay(Record& record) : record_(record) {}
  std::unique_ptr<DeviceTexture> share(uint32_t texture, size_t row_bytes, size_t rows) override {
    record_.events +=
        "share" + std::to_string(texture) + ":" + std::to_string(row_bytes) + "x" + std::to_string(rows) + " ";
    return record_.refuses_to_share ? nullptr : std::make_unique<FakeTexture>(record_);
  }
  void keep_on_device(bool keep) override { record_.events += keep ? "keep " : "copy "; }

 private:
  Record& record_;
};

class FakeImage final : public DeviceImage {
 public:
  explicit FakeImage(std::shared_ptr<DeviceDisplay> display, std::vector<Rgb> pixels = {})
      : display_(std::move(display)), pixels_(std::move(pixels)) {}
  const std::shared_ptr<DeviceDisplay>& display() const override { return display_; }
  size_t size_bytes() const override { return pixels_.size() * sizeof(Rgb); }
  std::span<const std::byte> bytes() override { return std::as_bytes(std::span(pixels_)); }
  bool read(size_t first, std::span<std::byte> to) override {
    if (fails) return false;
    std::memcpy(to.data(), bytes().data() + first, to.size());
    return true;
  }

  bool fails = false;

 private:
  std::shared_ptr<DeviceDisplay> display_;
  std::vector<Rgb> pixels_;
};

class FrameTextureTest : public ::testing::Test {
 protected:
  bool write(int width = 10, int height = 4) {
    record_.events.clear();
    return texture_.write(image_, width, height);
  }

  Record record_;
  uint32_t name_ = 3;
  FrameTexture texture_{[this](int width, int height) {
    record_.events += "allocate" + std::to_string(width) + "x" + std::to_string(height) + " ";
    return name_;
  }};
  FakeImage image_{std::make_shared<FakeDisplay>(record_)};
};

TEST_F(FrameTextureTest, TakesImagesIfTheDriverCanWriteIt) {
  EXPECT_TRUE(write());
  EXPECT_EQ(record_.events, "allocate30x4 share3:120x4 write keep ");
  EXPECT_TRUE(write());
  EXPECT_EQ(record_.events, "write keep ");
}

TEST_F(FrameTextureTest, IsSharedAgainWithAnotherSize) {
  write();
  EXPECT_TRUE(write(20, 8));
  EXPECT_EQ(record_.events, "close allocate60x8 share3:240x8 write keep ");
}

TEST_F(FrameTextureTest, IsTriedOnceWithADriverThatRefusesIt) {
  record_.refuses_to_share = true;
  EXPECT_FALSE(write());
  EXPECT_EQ(record_.events, "allocate30x4 share3:120x4 copy ");
  EXPECT_FALSE(write(20, 8));
  EXPECT_EQ(record_.events, "");
}

TEST_F(FrameTextureTest, IsGivenUpAfterAWriteThatFails) {
  EXPECT_TRUE(write());
  record_.refuses_to_write = true;
  EXPECT_FALSE(write());
  EXPECT_EQ(record_.events, "write close copy ");
  record_.refuses_to_write = false;
  EXPECT_FALSE(write());
}

TEST_F(FrameTextureTest, IsNotSharedIfItCannotBeThatLarge) {
  name_ = 0;
  EXPECT_FALSE(write());
  EXPECT_EQ(record_.events, "allocate30x4 copy ");
}

TEST_F(FrameTextureTest, IsTriedAgainWithAnotherDevice) {
  record_.refuses_to_share = true;
  EXPECT_FALSE(write());
  record_ = {};
  FakeImage other(std::make_shared<FakeDisplay>(record_));
  EXPECT_TRUE(texture_.write(other, 10, 4));
  EXPECT_EQ(record_.events, "allocate30x4 share3:120x4 write keep ");
  texture_.close();
  EXPECT_TRUE(record_.events.ends_with("close "));
}

TEST_F(FrameTextureTest, PixelsAreReadWhereTheyAre) {
  ViewerFrame frame;
  frame.width = 2;
  frame.height = 1;
  frame.radiance = {Rgb(1), Rgb(2)};
  EXPECT_EQ(radiance_at(frame, 1), Rgb(2));
  EXPECT_EQ(radiance_of(frame).size(), 2u);
  frame.radiance.clear();
  const auto image = std::make_shared<FakeImage>(image_.display(), std::vector<Rgb>{Rgb(3), Rgb(4, 5, 6)});
  frame.device_image = image;
  EXPECT_EQ(radiance_at(frame, 1), Rgb(4, 5, 6));
  EXPECT_EQ(radiance_of(frame), (std::vector<Rgb>{Rgb(3), Rgb(4, 5, 6)}));
  EXPECT_EQ(describe_pixel(frame, {0.9f, 0.5f}), "(1, 0)  RGB 4 5 6");
  image->fails = true;
  EXPECT_EQ(radiance_at(frame, 1), Rgb(0));
  EXPECT_TRUE(radiance_of(frame).empty());
}

}  // namespace
}  // namespace relume::viewer

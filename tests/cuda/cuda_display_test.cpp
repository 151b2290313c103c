// Images for windows on the stub driver: through page-locked memory, and by textures that the GPU writes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/array.h"
#include "determinism/same_bits.h"
#include "frame/cuda/cuda_device.h"
#include "frame/device_display.h"
#include "framebuffer/auto_exposure.h"
#include "kernels.h"
#include "launch_kernel.h"
#include "relume/error.h"
#include "render/session.h"
#include "stub_driver.h"

namespace relume::cuda {
namespace {

using testing::AddKernel;
using testing::queue;
using testing::queue_waiting;
using testing::StubDriver;

constexpr uint32_t kWidth = 100;
constexpr uint32_t kHeight = 6;
constexpr size_t kRowBytes = kWidth * sizeof(uint32_t);
constexpr size_t kImageBytes = kRowBytes * kHeight;
constexpr unsigned kTexture = 5;

std::vector<uint32_t> numbers(std::span<const std::byte> bytes) {
  std::vector<uint32_t> values(bytes.size() / sizeof(uint32_t));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

bool all_are(const std::vector<uint32_t>& values, uint32_t value) {
  return values.size() == kWidth * kHeight &&
         std::all_of(values.begin(), values.end(), [&](uint32_t v) { return v == value; });
}

std::vector<uint32_t> texture_content() {
  return numbers({static_cast<const std::byte*>(StubDriver::texture(kTexture)), kImageBytes});
}

/// Runs with work that is executed at once, or when the host waits for it.
class CudaDisplayTest : public ::testing::TestWithParam<const char*> {
 protected:
  CudaDisplayTest() {
    StubDriver::make_texture(kTexture, kRowBytes, kHeight);
    pixels_.assign(kWidth * kHeight, 0);
  }
  ~CudaDisplayTest() override {
    pixels_ = Array<uint32_t>();
    device_.reset();  // waits for copies to the texture
    StubDriver::make_texture(kTexture, 0, 0);
  }

  /// A frame that adds 1 to all pixels.
  void render() { queue_waiting(*device_, AddKernel{1, pixels_.mutable_view()}, {0, 0, kWidth * kHeight, 1}); }
  std::shared_ptr<DeviceImage> copy() { return device_->copy_image(pixels_.view().data, kImageBytes); }

  StubDriver stub_{GetParam()};
  std::unique_ptr<Device> device_ = open_device(stub_.driver(), testing::test_device_code());
  Array<uint32_t> pixels_{device_->memory()};
};

TEST_P(CudaDisplayTest, CopiesImagesToPageLockedMemory) {
  render();
  const std::shared_ptr<DeviceImage> image = copy();
  ASSERT_TRUE(image);
  EXPECT_EQ(image->size_bytes(), kImageBytes);
  render();  // while the image is copied
  EXPECT_TRUE(all_are(numbers(image->bytes()), 1));
  uint32_t last = 0;
  EXPECT_TRUE(image->read(kImageBytes - 4, std::as_writable_bytes(std::span(&last, 1))));
  EXPECT_EQ(last, 1u);
  EXPECT_EQ(pixels_.read()[0], 2u);
}

TEST_P(CudaDisplayTest, KeepsTwoImagesWhileTheNextOneIsRendered) {
  std::vector<std::shared_ptr<DeviceImage>> images;
  for (uint32_t frame = 1; frame <= 12; ++frame) {
    render();
    images.push_back(copy());
    ASSERT_TRUE(images.back()) << frame;
    if (frame < 3) continue;
    EXPECT_TRUE(all_are(numbers(images[images.size() - 3]->bytes()), frame - 2)) << "copied while two frames followed";
    images.erase(images.begin());
  }
  EXPECT_LE(StubDriver::objects("locked"), 1u + 3u) << "of launches, and of images that are used again";
}

TEST_P(CudaDisplayTest, HasNoImageIfAllAreInUse) {
  std::vector<std::shared_ptr<DeviceImage>> images;
  for (int i = 0; i < 4; ++i) {
    images.push_back(copy());
    ASSERT_TRUE(images.back());
  }
  EXPECT_FALSE(copy());
  images.pop_back();
  EXPECT_TRUE(copy());
}

TEST_P(CudaDisplayTest, WritesTextures) {
  render();
  const std::shared_ptr<DeviceImage> first = copy();
  const std::shared_ptr<DeviceDisplay> display = first->display();
  const std::unique_ptr<DeviceTexture> texture = display->share(kTexture, kRowBytes, kHeight);
  ASSERT_TRUE(texture);
  EXPECT_TRUE(texture->write(*first));
  EXPECT_TRUE(all_are(texture_content(), 1));
  display->keep_on_device(true);
  const size_t copies = StubDriver::calls("cuMemcpyDtoHAsync_v2");
  render();
  const std::shared_ptr<DeviceImage> second = copy();
  EXPECT_TRUE(texture->write(*second));
  render();  // while the texture is written
  EXPECT_TRUE(all_are(texture_content(), 2));
  EXPECT_EQ(StubDriver::calls("cuMemcpyDtoHAsync_v2"), copies) << "nothing is copied to the host";
  EXPECT_TRUE(second->bytes().empty());
  uint32_t pixel = 0;
  EXPECT_TRUE(second->read(8, std::as_writable_bytes(std::span(&pixel, 1))));
  EXPECT_EQ(pixel, 2u);
}

TEST_P(CudaDisplayTest, WritesEachImageBeforeItsMemoryIsUsedAgain) {
  std::unique_ptr<DeviceTexture> texture;
  for (uint32_t frame = 1; frame <= 10; ++frame) {
    render();
    const std::shared_ptr<DeviceImage> image = copy();
    if (!texture) texture = image->display()->share(kTexture, kRowBytes, kHeight);
    image->display()->keep_on_device(true);
    ASSERT_TRUE(texture->write(*image));
    if (frame % 3 == 0) {
      EXPECT_TRUE(all_are(texture_content(), frame));
    }
  }
}

TEST_P(CudaDisplayTest, LivesLongerThanTheDevice) {
  render();
  std::shared_ptr<DeviceImage> image = copy();
  std::unique_ptr<DeviceTexture> texture = image->display()->share(kTexture, kRowBytes, kHeight);
  device_->finish();
  pixels_ = Array<uint32_t>();
  device_.reset();
  EXPECT_EQ(StubDriver::objects("contexts"), 1u);
  EXPECT_TRUE(all_are(numbers(image->bytes()), 1));
  EXPECT_TRUE(texture->write(*image));
  EXPECT_TRUE(all_are(texture_content(), 1));
  texture.reset();
  EXPECT_EQ(StubDriver::objects("textures"), 0u);
  image.reset();
  EXPECT_EQ(StubDriver::objects("contexts"), 0u);
  EXPECT_EQ(StubDriver::objects("leaked"), 0u);
}

INSTANTIATE_TEST_SUITE_P(Drivers, CudaDisplayTest, ::testing::Values("", "eager=1"),
                         [](const auto& tested) { return std::string(tested.index == 0 ? "deferred" : "eager"); });

/// A device, an array of one image, and its copy.
struct Shown {
  explicit Shown(const StubDriver& stub) : device(open_device(stub.driver(), testing::test_device_code())) {
    pixels.assign(kWidth * kHeight, 3);
    queue(*device, AddKernel{1, pixels.mutable_view()}, {0, 0, kWidth * kHeight, 1});
  }
  std::shared_ptr<DeviceImage> copy() { return device->copy_image(pixels.view().data, kImageBytes); }

  std::unique_ptr<Device> device;
  Array<uint32_t> pixels{device->memory()};
};

TEST(CudaDisplay, RefusesTexturesThatTheDriverDoesNotKnow) {
  const StubDriver stub;
  Shown shown(stub);
  const std::shared_ptr<DeviceImage> image = shown.copy();
  EXPECT_FALSE(image->display()->share(kTexture, kRowBytes, kHeight)) << "no OpenGL";
  EXPECT_TRUE(all_are(numbers(image->bytes()), 4));
  StubDriver::make_texture(kTexture, kRowBytes, kHeight);
  EXPECT_FALSE(image->display()->share(kTexture, kRowBytes, kHeight + 1)->write(*image)) << "not the image's size";
  StubDriver::make_texture(kTexture, 0, 0);
}

TEST(CudaDisplay, RefusesTexturesThatAnotherGpuDraws) {
  const StubDriver stub("devices=2");
  StubDriver::make_texture(kTexture, kRowBytes, kHeight);
  {
    const std::unique_ptr<Device> device = open_device(stub.driver(), testing::test_device_code(), {.index = 1});
    Array<uint32_t> pixels(device->memory());
    pixels.assign(kWidth * kHeight, 3);
    const std::shared_ptr<DeviceImage> image = device->copy_image(pixels.view().data, kImageBytes);
    EXPECT_FALSE(image->display()->share(kTexture, kRowBytes, kHeight));
    EXPECT_EQ(StubDriver::calls("cuGraphicsGLRegisterImage"), 0u);
    EXPECT_TRUE(all_are(numbers(image->bytes()), 3));
  }
  StubDriver::make_texture(kTexture, 0, 0);
}

TEST(CudaDisplay, RefusesTexturesOfDriversWithoutThem) {
  const StubDriver stub;
  Driver driver = stub.driver();
  EXPECT_TRUE(driver.has_textures());
  driver.cuGraphicsGLRegisterImage = nullptr;
  StubDriver::make_texture(kTexture, kRowBytes, kHeight);
  {
    const std::unique_ptr<Device> device = open_device(driver, testing::test_device_code());
    Array<uint32_t> pixels(device->memory());
    pixels.assign(kWidth * kHeight, 3);
    const std::shared_ptr<DeviceImage> image = device->copy_image(pixels.view().data, kImageBytes);
    EXPECT_FALSE(image->display()->share(kTexture, kRowBytes, kHeight));
    EXPECT_TRUE(all_are(numbers(image->bytes()), 3));
  }
  StubDriver::make_texture(kTexture, 0, 0);
}

TEST(CudaDisplay, UnmapsATextureThatCannotBeWritten) {
  StubDriver::make_texture(kTexture, kRowBytes, kHeight);
  for (const char* call : {"cuGraphicsMapResources", "cuGraphicsSubResourceGetMappedArray", "cuMemcpy2DAsync_v2",
                           "cuGraphicsUnmapResources", "cuStreamWaitEvent"}) {
    const StubDriver stub;
    Shown shown(stub);
    const std::shared_ptr<DeviceImage> image = shown.copy();
    const std::unique_ptr<DeviceTexture> texture = image->display()->share(kTexture, kRowBytes, kHeight);
    StubDriver::configure(std::string("fail=") + call + ":1:1");
    EXPECT_FALSE(texture->write(*image)) << call;
    EXPECT_TRUE(all_are(numbers(image->bytes()), 4)) << call;
    const bool is_unmapped = std::string(call) != "cuGraphicsUnmapResources";
    EXPECT_EQ(texture->write(*image), is_unmapped) << call;
  }
  StubDriver::make_texture(kTexture, 0, 0);
}

TEST(CudaDisplay, HasNoImageWithoutMemory) {
  const StubDriver stub("memory=257");  // 256 MiB are spare
  Shown shown(stub);
  const size_t used = shown.device->statistics()->memory_used_bytes;
  std::shared_ptr<DeviceImage> image = shown.copy();
  ASSERT_TRUE(image);
  EXPECT_EQ(shown.device->statistics()->memory_used_bytes, used + kImageBytes);
  Array<std::byte> large(shown.device->memory());
  large.reset((size_t{1} << 20) - used - kImageBytes - 100, kUninitialized);
  EXPECT_FALSE(shown.copy()) << "the limit of the GPU";
}

TEST(CudaDisplay, HasNoImageWithoutConcurrentAccess) {
  const StubDriver stub("concurrent=0");
  const std::unique_ptr<Device> device = open_device(stub.driver(), testing::test_device_code(), {});
  Array<uint32_t> pixels(device->memory());
  pixels.assign(kWidth * kHeight, 3);
  EXPECT_FALSE(device->copy_image(pixels.view().data, kImageBytes));
}

TEST(CudaDisplay, LeavesErrorsOfLaunchesToTheCaller) {
  const StubDriver stub("fail=cuLaunchKernel:1:701");
  const std::unique_ptr<Device> device = open_device(stub.driver(), testing::test_device_code());
  Array<uint32_t> pixels(device->memory());
  pixels.assign(kWidth * kHeight, 3);
  queue_waiting(*device, AddKernel{1, pixels.mutable_view()}, {0, 0, kWidth * kHeight, 1});
  EXPECT_THROW(device->copy_image(pixels.view().data, kImageBytes), Error);
  const std::shared_ptr<DeviceImage> image = device->copy_image(pixels.view().data, kImageBytes);
  ASSERT_TRUE(image) << "the device has survived";
  EXPECT_TRUE(all_are(numbers(image->bytes()), 3));
}

TEST(CudaDisplay, HasNoPixelsAfterTheLossOfTheGpu) {
  const StubDriver stub("lose=1");
  Shown shown(stub);
  const std::shared_ptr<DeviceImage> image = shown.copy();
  ASSERT_TRUE(image);
  EXPECT_TRUE(image->bytes().empty());
  uint32_t pixel = 0;
  EXPECT_FALSE(image->read(0, std::as_writable_bytes(std::span(&pixel, 1))));
  EXPECT_THROW(shown.device->finish(), Error);
  EXPECT_THROW(shown.copy(), Error);
}

TEST(CudaDisplay, ShowsTheImageOfASession) {
  const StubDriver stub("open=1");
  RenderSettings settings;
  settings.width = 48;
  settings.height = 32;
  settings.threads = 1;
  settings.device = "cuda";
  Session session(support::build("cornell"), settings);
  EXPECT_FALSE(copy_device_image(session)) << "no frame yet";
  for (const bool denoises : {false, true}) {
    settings.denoise = denoises ? DenoiseChoice::svgf : DenoiseChoice::none;
    ASSERT_TRUE(session.set_settings(settings));
    session.render_frame();
    session.render_frame();
    const std::shared_ptr<DeviceImage> image = copy_device_image(session);
    ASSERT_TRUE(image);
    const float metered = meter_device_image(session);
    const std::span<const std::byte> bytes = image->bytes();
    const std::vector<Rgb> pixels = session.image().pixels;
    ASSERT_EQ(bytes.size(), pixels.size() * sizeof(Rgb));
    EXPECT_EQ(std::memcmp(bytes.data(), pixels.data(), bytes.size()), 0) << denoises;
    EXPECT_EQ(metered, auto_exposure(pixels)) << denoises;
  }
  session.replace_image(session.image());
  EXPECT_FALSE(copy_device_image(session)) << "the image is on the host";
  settings.device = "cpu";
  Session host(support::build("cornell"), settings);
  host.render_frame();
  EXPECT_FALSE(copy_device_image(host));
}

}  // namespace
}  // namespace relume::cuda

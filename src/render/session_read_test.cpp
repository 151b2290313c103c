#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "core/srgb.h"
#include "files/testing/temp_folder.h"
#include "framebuffer/tone_map.h"
#include "relume/error.h"
#include "render/session.h"

namespace relume {
namespace {

constexpr int kWidth = 12;
constexpr int kHeight = 8;

RenderSettings small_settings(int threads = 1) {
  RenderSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  settings.threads = threads;
  return settings;
}

Session cornell(int frames, const RenderSettings& settings = small_settings()) {
  Session session(find_builtin_scene("cornell")->build(), settings);
  for (int i = 0; i < frames; ++i) session.render_frame();
  return session;
}

bool is_black(const Image& image) {
  return std::all_of(image.pixels.begin(), image.pixels.end(), [](const Rgb& c) { return c == Rgb(0); });
}

/// The camera, moved by one metre to the right.
CameraPose moved(const Session& session) {
  CameraPose camera = session.camera();
  camera.to_world[3].x += 1;
  return camera;
}

TEST(SessionRead, BlackBeforeTheFirstFrame) {
  const Session session = cornell(0);
  EXPECT_TRUE(is_black(session.image()));
  std::vector<float> pixels(kWidth * kHeight * 3, 1.0f);
  session.read({.pixels = pixels.data(), .width = kWidth, .height = kHeight});
  EXPECT_EQ(std::count(pixels.begin(), pixels.end(), 0.0f), kWidth * kHeight * 3);
}

TEST(SessionRead, LayoutsHoldTheSameImage) {
  const Session session = cornell(2);
  const Image image = session.image();
  ASSERT_FALSE(is_black(image));
  std::vector<Rgb> rgb(kWidth * kHeight);
  session.read({.pixels = rgb.data(), .width = kWidth, .height = kHeight});
  EXPECT_EQ(rgb, image.pixels);
  std::vector<Vec4> rgba(kWidth * kHeight);
  session.read({.pixels = rgba.data(), .width = kWidth, .height = kHeight, .layout = PixelLayout::rgba32f});
  std::vector<uint8_t> bytes(kWidth * kHeight * 4);
  session.read({.pixels = bytes.data(), .width = kWidth, .height = kHeight, .layout = PixelLayout::rgba8},
               ToneMap::reinhard, 1);
  for (size_t i = 0; i < rgb.size(); ++i) {
    EXPECT_EQ(rgba[i], Vec4(rgb[i], 1));
    const Rgb shown = srgb_from_linear(tone_map(ToneMap::reinhard, 1, rgb[i]));
    for (int c = 0; c < 3; ++c) EXPECT_EQ(bytes[4 * i + static_cast<size_t>(c)], quantise_unorm8(shown[c]));
    EXPECT_EQ(bytes[4 * i + 3], 255);
  }
}

TEST(SessionRead, RowsMayBeApart) {
  const Session session = cornell(1);
  constexpr size_t kStride = kWidth * sizeof(Rgb) + 20;
  std::vector<std::byte> memory(kStride * kHeight, std::byte{7});
  session.read({.pixels = memory.data(), .width = kWidth, .height = kHeight, .row_stride = kStride});
  const Image image = session.image();
  for (size_t y = 0; y < kHeight; ++y) {
    EXPECT_EQ(std::memcmp(&memory[y * kStride], &image.at(0, static_cast<int>(y)), kWidth * sizeof(Rgb)), 0);
    for (size_t i = kWidth * sizeof(Rgb); i < kStride; ++i) EXPECT_EQ(memory[y * kStride + i], std::byte{7});
  }
}

TEST(SessionRead, RejectsInvalidTargets) {
  const Session session = cornell(1);
  std::vector<Rgb> pixels(kWidth * kHeight);
  EXPECT_THROW(session.read({.width = kWidth, .height = kHeight}), Error);
  EXPECT_THROW(session.read({.pixels = pixels.data(), .width = kHeight, .height = kWidth}), Error);
  EXPECT_THROW(session.read({.pixels = pixels.data(), .width = kWidth, .height = kHeight, .row_stride = 8}), Error);
}

TEST(SessionRead, ShowsTheLastCompleteFrameAfterAChange) {
  Session session = cornell(2);
  const Image before = session.image();
  session.set_camera(moved(session));
  EXPECT_EQ(session.image().pixels, before.pixels);
  // A frame stopped before completion does not change the displayed image.
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(session.render_frame(stop.get_token()));
  EXPECT_EQ(session.image().pixels, before.pixels);
  EXPECT_TRUE(session.render_frame());
  EXPECT_NE(session.image().pixels, before.pixels);
}

TEST(SessionRead, ShowsTheLastCompleteFrameAfterAnotherTechniqueIsChosen) {
  Session session = cornell(2);
  const Image before = session.image();
  RenderSettings settings = small_settings();
  settings.denoise = DenoiseChoice::svgf;
  ASSERT_TRUE(session.set_settings(settings));
  EXPECT_EQ(session.image().pixels, before.pixels);
  session.render_frame();
  EXPECT_NE(session.image().pixels, before.pixels);
  settings.width = 2 * kWidth;
  ASSERT_TRUE(session.set_settings(settings));
  EXPECT_TRUE(is_black(session.image())) << "there is none of that size";
}

TEST(SessionRead, ALoadedCheckpointReplacesTheImageThatWasKept) {
  const TempFolder folder;
  const Session source = cornell(4);
  source.save_checkpoint(folder / "a.ckpt");
  Session session = cornell(2);
  session.set_camera(moved(session));
  std::stop_source stop;
  stop.request_stop();
  session.render_frame(stop.get_token());  // displays the previous frame
  session.set_camera({});
  session.load_checkpoint(folder / "a.ckpt");
  EXPECT_EQ(session.image().pixels, source.image().pixels);
}

TEST(SessionRead, SnapshotsStayUnchanged) {
  Session session = cornell(1);
  const std::shared_ptr<const Image> snapshot = session.snapshot();
  const std::vector<Rgb> pixels = snapshot->pixels;
  session.render_frame();
  EXPECT_EQ(snapshot->pixels, pixels);
  EXPECT_NE(session.snapshot()->pixels, pixels);
}

TEST(SessionRead, BuffersAreThoseWithoutRecords) {
  const Session session = cornell(1);
  const std::vector<BufferInfo> list = session.buffers();
  ASSERT_FALSE(list.empty());
  for (const BufferInfo& info : list) {
    const BufferData data = session.buffer(info.name);
    EXPECT_EQ(data.bytes.size(), info.row_stride * info.height) << info.name;
    EXPECT_EQ(info.pixel_stride, info.channels * 4) << info.name;
    EXPECT_EQ(info.row_stride, info.pixel_stride * kWidth) << info.name;
  }
  const BufferData rays = session.buffer("rays");
  EXPECT_EQ(rays.info.type, ElementType::uint32);
  EXPECT_EQ(std::memcmp(rays.bytes.data(), buffer_table(session).view(kRays).data, rays.bytes.size()), 0);
  EXPECT_THROW(session.buffer("primary-hits"), Error) << "its elements are records";
  EXPECT_THROW(session.buffer("nothing"), Error);
}

TEST(SessionRead, TheHookSeesEachPass) {
  Session session = cornell(0);
  std::vector<std::string> seen;
  session.on_pass([&](const std::string& pass) { seen.push_back(pass); });
  session.render_frame();
  std::vector<std::string> declared;
  for (const PassDeclaration& pass : pass_declarations(session)) declared.emplace_back(pass.name);
  EXPECT_EQ(seen, declared);
  session.on_pass({});
  session.render_frame();
  EXPECT_EQ(seen, declared);
}

TEST(Sessions, WithOtherNumbersOfThreadsRunAtOnce) {
  const Image alone = cornell(16).image();
  Image images[2];
  int threads[2] = {};
  {
    std::vector<std::jthread> runners;
    for (int i = 0; i < 2; ++i) {
      runners.emplace_back([&, i] {
        const Session session = cornell(16, small_settings(i + 1));
        images[i] = session.image();
        threads[i] = session.statistics().threads;
      });
    }
  }
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(threads[i], i + 1);
    EXPECT_EQ(images[i].pixels, alone.pixels);
  }
}

}  // namespace
}  // namespace relume

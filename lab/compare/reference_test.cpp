#include "compare/reference.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "relume/error.h"
#include "relume/image_io.h"
#include "relume/lab/metrics.h"

namespace relume {
namespace {

/// An empty folder, removed with its content.
class ReferenceTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = std::filesystem::temp_directory_path() / ("relume_reference_" + name);
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  size_t file_count() const {
    size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_)) ++count;
    return count;
  }

  static RenderSettings small() {
    RenderSettings settings;
    settings.width = 24;
    settings.height = 18;
    settings.path.max_bounces = 3;
    return settings;
  }

  std::filesystem::path folder_;
};

TEST_F(ReferenceTest, IsRenderedOnce) {
  const Scene scene = find_builtin_scene("cornell")->build();
  const auto first = ReferenceRenderer(scene, small(), 16, folder_).render(0, {}, {});
  ASSERT_TRUE(first);
  EXPECT_FALSE(first->cached);
  EXPECT_EQ(first->spp, 16);
  EXPECT_EQ(file_count(), 1u);  // no checkpoint remains
  const auto second = ReferenceRenderer(scene, small(), 16, folder_).render(0, {}, {});
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->cached);
  EXPECT_EQ(first->image.pixels, second->image.pixels);
  EXPECT_EQ(first->mse, second->mse);
  EXPECT_EQ(first->surface.depth, second->surface.depth);
}

TEST_F(ReferenceTest, RendersAgainForAnotherProgram) {
  const Scene scene = find_builtin_scene("cornell")->build();
  EXPECT_FALSE(ReferenceRenderer(scene, small(), 4, folder_, "yesterday").render(0, {}, {})->cached);
  EXPECT_FALSE(ReferenceRenderer(scene, small(), 4, folder_, "today").render(0, {}, {})->cached);
  EXPECT_TRUE(ReferenceRenderer(scene, small(), 4, folder_, "today").render(0, {}, {})->cached);
}

TEST_F(ReferenceTest, DifferentReferencesHaveSeparateFiles) {
  const Scene cornell = find_builtin_scene("cornell")->build();
  const Scene spheres = find_builtin_scene("cornell-spheres")->build();
  RenderSettings settings = small();
  const auto file = [&](const Scene& scene, const RenderSettings& s, int spp, float time_s = 0) {
    return ReferenceRenderer(scene, s, spp, folder_).file(time_s, 0, {});
  };
  const auto first = file(cornell, settings, 16);
  EXPECT_NE(first, file(spheres, settings, 16));
  EXPECT_NE(first, file(cornell, settings, 32));
  EXPECT_NE(first, file(cornell, settings, 16, 0.5f));
  CameraPose camera;
  EXPECT_NE(first, ReferenceRenderer(cornell, settings, 16, folder_).file(0, 0, camera));
  settings.threads = 3;
  settings.seed = 5;
  EXPECT_EQ(first, file(cornell, settings, 16));
  settings.path.max_bounces = 4;
  EXPECT_NE(first, file(cornell, settings, 16));
}

TEST_F(ReferenceTest, StatesItsOwnError) {
  // Against an independent image of 512 samples, the distance is the sum of both variances. The lamp is out of view: a
  // few pixels on its edges would outweigh all others.
  Scene scene = find_builtin_scene("cornell")->build();
  scene.cameras.front().fov_y_rad *= 0.5f;
  const auto reference = ReferenceRenderer(scene, small(), 64, folder_).render(0, {}, {});
  Session session(scene, small());
  for (int i = 0; i < 512; ++i) session.render_frame();
  const double distance = compute_metrics(session.image(), reference->image, {.flip = false}).mse;
  EXPECT_GT(reference->mse, 0);
  double by_pixel = 0;
  for (const Rgb& e : reference->squared_error.pixels) by_pixel += (e.x + e.y + e.z) / 3.0;
  EXPECT_NEAR(by_pixel / static_cast<double>(reference->squared_error.pixels.size()), reference->mse,
              1e-5 * reference->mse);
  // 1 296 values, and low-discrepancy points converge faster than 1/n: the estimate must be correct within a factor of
  // two.
  EXPECT_GT(distance, 0.5 * reference->mse);
  EXPECT_LT(distance, 2.5 * reference->mse);
}

TEST_F(ReferenceTest, ContinuesAfterAnInterruption) {
  const Scene scene = find_builtin_scene("cornell")->build();
  const auto whole = ReferenceRenderer(scene, small(), 40, folder_).render(0, {}, {});
  const auto file = ReferenceRenderer(scene, small(), 40, folder_).file(0, 0, {});
  std::filesystem::remove(file);
  // Interrupts twice: in the first half and in the second.
  for (double share : {0.2, 0.7}) {
    std::stop_source stop;
    const auto stopped = ReferenceRenderer(scene, small(), 40, folder_).render(0, stop.get_token(), [&](double f) {
      if (f >= share) stop.request_stop();
    });
    EXPECT_FALSE(stopped);
    EXPECT_FALSE(std::filesystem::exists(file));
    EXPECT_GT(file_count(), 0u);
  }
  double first_fraction = -1;
  const auto resumed = ReferenceRenderer(scene, small(), 40, folder_).render(0, {}, [&](double f) {
    if (first_fraction < 0) first_fraction = f;
  });
  ASSERT_TRUE(resumed);
  EXPECT_GT(first_fraction, 0.7);
  EXPECT_EQ(whole->image.pixels, resumed->image.pixels);
  EXPECT_EQ(whole->surface.depth, resumed->surface.depth);
  EXPECT_EQ(whole->surface.normal, resumed->surface.normal);
  EXPECT_EQ(whole->surface.motion, resumed->surface.motion);
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(ReferenceTest, StoresMotionOfSurfaces) {
  const Scene scene = find_builtin_scene("cornell-closed")->build();
  const auto still = ReferenceRenderer(scene, small(), 4, folder_).render(0, {}, {});
  const auto turned = ReferenceRenderer(scene, small(), 4, folder_).render(0.2f, 0.1f, {}, {}, {});
  const size_t middle = 9 * 24 + 12;
  EXPECT_LT(std::hypot(still->surface.motion[middle].x, still->surface.motion[middle].y), 1e-3f);
  // One degree in an image 24 pixels wide that covers 75°: a third of a pixel.
  EXPECT_NEAR(std::fabs(turned->surface.motion[middle].x), 0.3f, 0.15f);
  EXPECT_GT(turned->surface.depth[middle], 0.5f);
}

TEST_F(ReferenceTest, RejectsACachedImageOfAnotherSize) {
  const Scene scene = find_builtin_scene("cornell")->build();
  ReferenceRenderer renderer(scene, small(), 2, folder_);
  ASSERT_TRUE(renderer.render(0, {}, {}));
  const std::filesystem::path file = renderer.file(0, 0, std::nullopt);
  EXPECT_TRUE(renderer.render(0, {}, {})->cached);
  ExrFile exr = read_exr(file);
  exr.height /= 2;
  for (ExrChannel& channel : exr.channels) channel.values.resize(channel.values.size() / 2);
  write_exr(file, exr);
  try {
    renderer.render(0, {}, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("24 × 9 pixels, not 24 × 18"), std::string::npos) << error.what();
  }
}

TEST_F(ReferenceTest, WindowsOfImagesAreNoReference) {
  std::filesystem::create_directories(folder_);
  ExrFile exr{2, 1, exr_channels(Image(2, 1)), {}};
  write_exr(folder_ / "a.exr", exr);
  EXPECT_EQ(read_reference(folder_ / "a.exr").image.width, 2);
  exr.data_window = {.x = 1, .y = 0, .width = 1, .height = 1};
  write_exr(folder_ / "a.exr", exr);
  try {
    read_reference(folder_ / "a.exr");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("the file stores only the window 1,0,1,1"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace relume

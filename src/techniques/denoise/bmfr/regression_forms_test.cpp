// The forms of the block regression give the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "techniques/denoise/bmfr/regression_kernel.h"
#include "testing/group_emulation.h"

namespace relume {
namespace {

/// An image of random surfaces and light.
struct Image {
  Image(uint32_t image_width, uint32_t image_height, uint32_t seed) : width(image_width), height(image_height) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> uniform(0, 1);
    const auto vector = [&] { return Vec3(uniform(generator), uniform(generator), uniform(generator)); };
    for (uint32_t i = 0; i < width * height; ++i) {
      const bool surface = uniform(generator) < 0.9f;
      position.push_back(20.0f * vector() - Vec3(10));
      normal.push_back(glm::normalize(vector() - Vec3(0.5f)));
      albedo.push_back(surface ? vector() + Vec3(0.1f) : Vec3(0));
      light.push_back(vector() * vector() * 5.0f);
      samples.push_back(static_cast<uint32_t>(uniform(generator) * 12));
      square.push_back(sqr(luminance(light.back())) * (1.0f + uniform(generator)));
    }
    for (float& value : noise) value = 2.0f * uniform(generator) - 1.0f;
  }

  BlockRegressionKernel kernel(std::vector<Rgb>& fitted) const {
    fitted.assign(light.size(), Rgb(4));
    BlockRegressionKernel k;
    k.position = view_of(position);
    k.normal = view_of(normal);
    k.albedo = view_of(albedo);
    k.light = view_of(light);
    k.samples = view_of(samples);
    k.square = view_of(square);
    k.noise = view_of(noise);
    k.fitted = mutable_view_of(fitted);
    k.noise_scale = noise_scale;
    k.detail = detail;
    k.most_samples = 9;
    k.share = share;
    k.shift_x = shift.x;
    k.shift_y = shift.y;
    k.width = width;
    k.height = height;
    return k;
  }

  /// Compares all forms. Returns the number of fitted pixels. `case_name`: for messages.
  uint32_t compare_forms(const char* case_name) const {
    const uint32_t columns = BlockRegressionKernel::blocks(width);
    const uint32_t rows = BlockRegressionKernel::blocks(height);
    std::vector<Rgb> fits[3];
    for (const bool on_device : {false, true}) {
      Backend backend(1, on_device ? KernelForm::device : KernelForm::host);
      launch(backend, "fit", kernel(fits[on_device ? 1 : 0]), columns, rows, {}, 1);
    }
    testing::run_shuffled(kernel(fits[2]), columns, rows, width);
    const size_t bytes = light.size() * sizeof(Rgb);
    EXPECT_EQ(std::memcmp(fits[0].data(), fits[1].data(), bytes), 0) << case_name << ' ' << width << 'x' << height;
    EXPECT_EQ(std::memcmp(fits[0].data(), fits[2].data(), bytes), 0) << case_name << ' ' << width << 'x' << height;
    return static_cast<uint32_t>(std::count_if(fits[0].begin(), fits[0].end(), [](Rgb fit) { return fit != Rgb(4); }));
  }

  uint32_t width;
  uint32_t height;
  std::vector<Vec3> position;
  std::vector<Vec3> normal;
  std::vector<Rgb> albedo;
  std::vector<Rgb> light;
  std::vector<uint32_t> samples;
  std::vector<float> square;
  std::vector<float> noise = std::vector<float>(kBlockNoise);
  float noise_scale = 0.01f;
  float detail = 1.5f;
  float share = 1;
  UVec2 shift{0, 0};
};

TEST(BlockRegressionForms, AgreeOnEdgeSizes) {
  for (const UVec2 size : {UVec2(1, 1), UVec2(7, 5), UVec2(8, 40), UVec2(32, 32), UVec2(33, 31), UVec2(70, 45)}) {
    for (const UVec2 shift : {UVec2(0, 0), UVec2(31, 1)}) {
      Image image(size.x, size.y, size.x + shift.x);
      image.shift = shift;
      EXPECT_GT(image.compare_forms("edge"), size.x * size.y / 2) << size.x;
    }
  }
}

TEST(BlockRegressionForms, AgreeOnThreads) {
  const Image image(50, 40, 8);
  const uint32_t columns = BlockRegressionKernel::blocks(image.width);
  const uint32_t rows = BlockRegressionKernel::blocks(image.height);
  std::vector<Rgb> fits[2];
  Backend backend(1);
  launch(backend, "fit", image.kernel(fits[0]), columns, rows, {}, 1);
  testing::run_threaded(image.kernel(fits[1]), columns, rows);
  EXPECT_EQ(fits[0], fits[1]);
}

TEST(BlockRegressionForms, AgreeWithAllSettings) {
  for (const float detail : {0.0f, 0.2f, 1000.0f}) {
    for (const float noise_scale : {0.0f, 0.1f}) {
      Image image(64, 40, 5);
      image.shift = UVec2(13, 7);
      image.detail = detail;
      image.noise_scale = noise_scale;
      image.share = detail > 0 ? 0.25f : 1.0f;
      image.compare_forms("settings");
    }
  }
}

TEST(BlockRegressionForms, AgreeOnNumbersThatAreNotFinite) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Image image(70, 70, 9);  // blocks with and without such numbers
  image.position[3 * 70 + 5].x = kInf;
  image.position[4 * 70 + 40].y = -kInf;
  image.position[40 * 70 + 6].z = kNan;
  image.light[9 * 70 + 12] = Rgb(kInf, 1, 0);
  image.light[36 * 70 + 68].y = kNan;
  image.light[69 * 70 + 69].z = -kInf;
  image.compare_forms("not finite");
}

TEST(BlockRegressionForms, AgreeWhereFeaturesDependOnEachOther) {
  Image plane(64, 64, 6);
  plane.noise_scale = 0;
  for (size_t i = 0; i < plane.position.size(); ++i) {
    plane.position[i].z = 0;
    plane.normal[i] = Vec3(0, 0, 1);
  }
  plane.compare_forms("plane");

  Image empty(40, 40, 7);
  for (Rgb& albedo : empty.albedo) albedo = Rgb(0);
  EXPECT_EQ(empty.compare_forms("empty"), 0u);
}

}  // namespace
}  // namespace relume

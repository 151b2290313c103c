#include "techniques/temporal/reprojection/specular_history.h"

#include <gtest/gtest.h>

#include <vector>

namespace relume {
namespace {

constexpr uint32_t kWidth = 8;

/// One row of a floor whose reflections move by two pixels while it stands still.
struct Row {
  std::vector<Vec2> motion = std::vector<Vec2>(kWidth, Vec2(2, 0));
  std::vector<Vec3> position = std::vector<Vec3>(kWidth, Vec3(0));
  std::vector<Vec3> normal = std::vector<Vec3>(kWidth, Vec3(0, 1, 0));
  std::vector<float> depth = std::vector<float>(kWidth, 1.0f);
  std::vector<uint32_t> surface = std::vector<uint32_t>(kWidth, 3);
  std::vector<Rgb> specular = std::vector<Rgb>(kWidth, Rgb(0));
  std::vector<uint32_t> specular_samples = std::vector<uint32_t>(kWidth, 0);
  std::vector<Rgb> mean = std::vector<Rgb>(kWidth, Rgb(0));
  std::vector<uint32_t> samples = std::vector<uint32_t>(kWidth, 0);

  void detach(uint32_t max_samples) {
    const std::vector<Rgb> before = specular;
    const std::vector<uint32_t> samples_before = specular_samples;
    DetachSpecularKernel kernel;
    kernel.reflections = {view_of(motion),   view_of(position), view_of(normal),  view_of(depth), view_of(surface),
                          view_of(position), view_of(normal),   view_of(surface), kWidth,         1};
    kernel.specular_before = view_of(before);
    kernel.samples_before = view_of(samples_before);
    kernel.specular = mutable_view_of(specular);
    kernel.samples = mutable_view_of(specular_samples);
    kernel.mean = mutable_view_of(mean);
    kernel.max_samples = max_samples;
    for (uint32_t x = 0; x < kWidth; ++x) kernel(x, 0);
  }
  void attach() {
    for (uint32_t x = 0; x < kWidth; ++x) AttachSpecularKernel{view_of(specular), mutable_view_of(mean), kWidth}(x, 0);
  }
  /// A sample joins the mean as AccumulateKernel does it, then its specular part.
  void add(const Rgb& radiance, const Rgb& found, const Rgb& albedo = Rgb(0.1f)) {
    const std::vector<Rgb> all(kWidth, radiance);
    const std::vector<Rgb> part(kWidth, found);
    const std::vector<Rgb> albedos(kWidth, albedo);
    AccumulateSpecularKernel kernel;
    kernel.radiance = view_of(all);
    kernel.found = view_of(part);
    kernel.albedo = view_of(albedos);
    kernel.samples = view_of(samples);
    kernel.specular = mutable_view_of(specular);
    kernel.specular_samples = mutable_view_of(specular_samples);
    kernel.mean = mutable_view_of(mean);
    kernel.width = kWidth;
    for (uint32_t x = 0; x < kWidth; ++x) {
      const float n = static_cast<float>(++samples[x]);
      mean[x] += (radiance - mean[x]) / n;
      kernel(x, 0);
    }
  }
};

TEST(SpecularHistory, LeavesTheMeanAsItIsWhereNothingMoves) {
  Row row;
  Rgb mean(0);
  for (int i = 1; i <= 5; ++i) {
    const Rgb radiance(0.3f * static_cast<float>(i * i));
    mean += (radiance - mean) / static_cast<float>(i);
    row.add(radiance, radiance * 0.37f);
  }
  EXPECT_EQ(row.mean[4], mean);
  EXPECT_NEAR(row.specular[4].r, 0.37f * mean.r, 1e-5f);
}

TEST(SpecularHistory, MovesWithTheReflection) {
  Row row;
  for (uint32_t x = 0; x < kWidth; ++x) {
    row.specular[x] = Rgb(x < 4 ? 2.0f : 0.0f);
    row.mean[x] = Rgb(x < 6 ? 1.0f : 5.0f) + row.specular[x];
    row.samples[x] = row.specular_samples[x] = 9;
  }
  row.detach(4);
  for (uint32_t x = 0; x < kWidth; ++x) EXPECT_EQ(row.mean[x], Rgb(x < 6 ? 1.0f : 5.0f)) << x;
  row.attach();
  for (uint32_t x = 2; x < kWidth; ++x) {
    EXPECT_EQ(row.mean[x], Rgb(x < 6 ? 1.0f : 5.0f) + Rgb(x < 6 ? 2.0f : 0.0f)) << x;
    EXPECT_EQ(row.specular_samples[x], 4u);  // capped
  }
  EXPECT_EQ(row.specular_samples[1], 0u);  // the image came from beyond the border
}

/// Each part is the mean of its own samples.
TEST(SpecularHistory, PartsCountBySamplesOfTheirOwn) {
  Row row;
  row.mean[5] = Rgb(3);  // of it 2 specular
  row.specular[5] = Rgb(2);
  row.samples[5] = 7;
  row.specular_samples[5] = 1;
  row.add(Rgb(10), Rgb(6));
  EXPECT_NEAR(row.mean[5].r, (1 + (4.0f - 1) / 8) + (2 + (6.0f - 2) / 2), 1e-5f);
  EXPECT_NEAR(row.specular[5].r, 4, 1e-6f);
}

TEST(SpecularHistory, SurfacesWithoutAnImageHaveNone) {
  Row row;
  row.add(Rgb(10), Rgb(6), Rgb(0));
  EXPECT_EQ(row.specular[0], Rgb(0));
  EXPECT_EQ(row.mean[0], Rgb(10));
}

}  // namespace
}  // namespace relume

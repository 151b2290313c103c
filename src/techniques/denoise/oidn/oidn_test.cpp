// Tests the calls with a mock of the library (testing/), so that they compile and run without it.
#include <OpenImageDenoise/oidn.hpp>

#include <gtest/gtest.h>

#include <vector>

#include "relume/error.h"
#include "techniques/denoise/oidn/oidn.h"
#include "techniques/denoise/oidn/oidn_filter.h"

namespace relume {
namespace {

TEST(Oidn, PassesTheImageAndItsFeatures) {
  ASSERT_TRUE(oidn_missing().empty());
  const std::vector<Rgb> color(6, Rgb(1, 2, 3));
  const std::vector<Rgb> albedo(6, Rgb(0.5f));
  const std::vector<Vec3> normal(6, Vec3(0, 0, 1));
  std::vector<Rgb> output(6, Rgb(0));
  oidn::log = {};
  oidn_filter({color.data(), albedo.data(), normal.data(), output.data(), 3, 2}, 2);
  EXPECT_TRUE(oidn::log.device_committed && oidn::log.filter_committed);
  EXPECT_EQ(oidn::log.device.at("numThreads"), 2);
  EXPECT_TRUE(oidn::log.flags.at("hdr"));
  EXPECT_EQ(oidn::log.width, 3u);
  EXPECT_EQ(oidn::log.height, 2u);
  EXPECT_EQ(oidn::log.images.at("albedo"), &albedo[0].x);
  EXPECT_EQ(oidn::log.images.at("normal"), &normal[0].x);
  for (const Rgb& pixel : output) EXPECT_EQ(pixel, Rgb(0.5f, 1, 1.5f));
}

TEST(Oidn, LeavesOutFeaturesThatAreNotGiven) {
  const std::vector<Rgb> color(6, Rgb(1, 2, 3));
  std::vector<Rgb> output(6, Rgb(0));
  oidn::log = {};
  oidn_filter({color.data(), nullptr, nullptr, output.data(), 3, 2}, 2);
  EXPECT_EQ(oidn::log.images.size(), 2u) << "colour and output";
  for (const Rgb& pixel : output) EXPECT_EQ(pixel, Rgb(0.5f, 1, 1.5f));
}

TEST(Oidn, CausticLayerAndRestAddUpToTheImage) {
  const std::vector<Rgb> image{Rgb(1, 2, 3), Rgb(0.5f), Rgb(-0.25f)};
  const std::vector<Rgb> caustics{Rgb(0.5f, 0, 1), Rgb(2), Rgb(0)};  // the second exceeds its image
  std::vector<Rgb> layer(3);
  std::vector<Rgb> rest(3);
  const OidnSplitKernel split{view_of(image), view_of(caustics), mutable_view_of(layer), mutable_view_of(rest), 3};
  for (uint32_t x = 0; x < 3; ++x) split(x, 0);
  EXPECT_EQ(layer, (std::vector<Rgb>{Rgb(0.5f, 0, 1), Rgb(0.5f), Rgb(0)}));
  EXPECT_EQ(rest, (std::vector<Rgb>{Rgb(0.5f, 2, 2), Rgb(0), Rgb(-0.25f)}));
  const OidnSumKernel sum{view_of(layer), mutable_view_of(rest), 3};
  for (uint32_t x = 0; x < 3; ++x) sum(x, 0);
  EXPECT_EQ(rest, image);
}

TEST(Oidn, ErrorsGiveTheReason) {
  std::vector<Rgb> pixel(1);
  oidn::log = {};
  oidn::log.failure = "out of memory";
  try {
    oidn_filter({pixel.data(), pixel.data(), pixel.data(), pixel.data(), 1, 1}, 1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("out of memory"), std::string::npos);
  }
}

TEST(Oidn, AuxiliaryImagesAreMeans) {
  const std::vector<Rgb> albedo{Rgb(0.2f)};
  const std::vector<Rgb> emission{Rgb(0)};
  const std::vector<Vec3> normal{Vec3(0, 1, 0)};
  const std::vector<Rgb> bright{Rgb(10)};
  std::vector<Rgb> mean_albedo(1);
  std::vector<Vec3> mean_normal(1);
  OidnAuxiliaryKernel kernel{view_of(albedo),
                             view_of(emission),
                             view_of(normal),
                             mutable_view_of(mean_albedo),
                             mutable_view_of(mean_normal),
                             1.0f,
                             1};
  kernel(0, 0);
  EXPECT_EQ(mean_albedo[0], Rgb(0.2f));
  kernel.feature_emission = view_of(bright);
  kernel.share = 0.5f;
  kernel(0, 0);
  EXPECT_NEAR(mean_albedo[0].g, 0.6f, 1e-6f);  // mean of 0.2 and a white emitter
  EXPECT_EQ(mean_normal[0], Vec3(0, 1, 0));
}

TEST(Oidn, FiltersLessOftenOverTime) {
  for (const uint32_t n : {1u, 2u, 3u, 7u, 15u, 16u, 18u, 64u, 72u, 1024u, 1152u}) EXPECT_TRUE(oidn_filters_at(n)) << n;
  for (const uint32_t n : {17u, 19u, 66u, 1025u, 1100u}) EXPECT_FALSE(oidn_filters_at(n)) << n;
}

}  // namespace
}  // namespace relume

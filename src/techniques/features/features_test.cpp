#include "techniques/features/features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "render/session.h"
#include "scene/builtin.h"
#include "scene/compiled_scene.h"
#include "techniques/features/picture_history.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 45;
constexpr uint32_t kHeight = 37;
constexpr uint32_t kPixels = kWidth * kHeight;

/// One frame of a built-in scene with the features of its pixels.
struct Frame {
  Frame(const char* scene, int max_bounces, EstimatorChoice estimator = EstimatorChoice::path)
      : session(find_builtin_scene(scene)->build(), settings(max_bounces, estimator)) {
    session.render_frame();
  }

  static RenderSettings settings(int max_bounces, EstimatorChoice estimator) {
    RenderSettings s;
    s.width = kWidth;
    s.height = kHeight;
    s.threads = 1;
    s.path.max_bounces = max_bounces;
    s.estimator = estimator;
    s.denoise = DenoiseChoice::svgf;  // asks for the features
    return s;
  }

  template <typename T>
  View<const T> view(const char* name) const {
    return session.buffers().view<const T>(name);
  }
  /// Whether the pixel shows its surface by way of a mirror or interface.
  bool indirect(uint32_t pixel) const {
    return view<uint32_t>("feature-surface")[pixel] != view<Hit>("primary-hits")[pixel].instance;
  }

  Session session;
};

TEST(Features, AMirrorIsAWindow) {
  const Frame frame("cornell-mirror", 8);
  const float mirror_z = -2.75f;
  const uint32_t mirror = frame.view<Hit>("primary-hits")[12 * kWidth + 22].instance;
  const uint32_t instances = 16;  // more than there are
  int seen = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    // By way of the mirror alone.
    const uint32_t instance = frame.view<uint32_t>("feature-surface")[i] ^ hash(mirror, 1u);
    const bool on_a_wall = max_component(abs(frame.view<Vec3>("feature-normal")[i])) > 0.999f;
    if (frame.view<Hit>("primary-hits")[i].instance != mirror || instance >= instances || !on_a_wall) continue;
    // Folded back, the place lies on a wall of the room.
    Vec3 p = frame.view<Vec3>("feature-position")[i];
    ASSERT_LT(p.z, mirror_z);
    p.z = 2.0f * mirror_z - p.z;
    const float off = relume::min(relume::min(std::fabs(std::fabs(p.x) - 2.75f), std::fabs(p.z - 11.0f)),
                                  relume::min(std::fabs(p.y), std::fabs(p.y - 5.5f)));
    EXPECT_LT(off, 0.011f) << i;  // the lamp hangs 1 cm below the ceiling
    EXPECT_GT(frame.view<float>("feature-depth")[i], frame.view<Hit>("primary-hits")[i].t);
    EXPECT_EQ(frame.view<Vec2>("feature-motion")[i], Vec2(0));
    ++seen;
  }
  EXPECT_GT(seen, 200);
}

TEST(Features, EmissionInMirrorsIsWhatPathsFindThere) {
  const Frame frame("cornell-mirror", 1);  // mirror, then nothing but emission
  int lamps = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (!frame.indirect(i)) continue;
    const Rgb radiance = frame.view<Rgb>("radiance")[i];
    const Rgb emission = frame.view<Rgb>("feature-emission")[i];
    EXPECT_LE(max_component(abs(radiance - emission)), 1e-5f * max_component(radiance)) << i;
    lamps += emission.r > 1.0f ? 1 : 0;
  }
  EXPECT_GT(lamps, 0);
}

TEST(Features, GlassIsSeenThrough) {
  const Frame frame("cornell-glass", 8);
  int through = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (!frame.indirect(i)) continue;
    EXPECT_GT(frame.view<float>("feature-depth")[i], frame.view<Hit>("primary-hits")[i].t);
    ++through;
  }
  EXPECT_GT(through, 50);
}

TEST(Features, DirectSurfacesAreTheFirstHits) {
  const Frame frame("cornell", 8);
  for (uint32_t i = 0; i < kPixels; ++i) {
    const Hit hit = frame.view<Hit>("primary-hits")[i];
    if (!hit.valid()) continue;
    EXPECT_FALSE(frame.indirect(i));
    EXPECT_EQ(frame.view<float>("feature-depth")[i], hit.t);
    EXPECT_NEAR(glm::length(frame.view<Vec3>("feature-normal")[i]), 1.0f, 1e-5f);
    EXPECT_LE(max_component(frame.view<Rgb>("feature-albedo")[i]), 1.0f);
  }
}

TEST(Features, TheBackgroundIsEmission) {
  const Frame frame("mine", 8);
  int background = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (frame.view<Hit>("primary-hits")[i].valid()) continue;
    EXPECT_EQ(frame.view<Rgb>("feature-albedo")[i], Rgb(0));
    EXPECT_EQ(frame.view<Rgb>("feature-emission")[i], frame.view<Rgb>("radiance")[i]);
    EXPECT_EQ(frame.view<uint32_t>("feature-surface")[i], kNoSurface);
    ++background;
  }
  EXPECT_GT(background, 0);
}

TEST(Features, LightTracingSeesNothingInMirrors) {
  const Frame frame("cornell-mirror", 8, EstimatorChoice::light);
  for (uint32_t i = 0; i < kPixels; ++i) EXPECT_FALSE(frame.indirect(i));
}

/// What FeatureKernel writes.
struct FeatureBuffers {
  FeatureKernel kernel(const CompiledScene& scene, const std::vector<Hit>& hits) {
    return {scene.view(),
            kIndex,
            view_of(hits),
            mutable_view_of(position),
            mutable_view_of(previous),
            mutable_view_of(normal),
            mutable_view_of(albedo),
            mutable_view_of(emission),
            mutable_view_of(depth),
            mutable_view_of(motion),
            mutable_view_of(surface),
            kMaxFeatureSteps,
            true,
            kWidth};
  }

  static constexpr SampleIndex kIndex{3, 0, 5, false};
  std::vector<Vec3> position = std::vector<Vec3>(kPixels);
  std::vector<Vec3> previous = position;
  std::vector<Vec3> normal = position;
  std::vector<Rgb> albedo = position;
  std::vector<Rgb> emission = position;
  std::vector<float> depth = std::vector<float>(kPixels);
  std::vector<Vec2> motion = std::vector<Vec2>(kPixels);
  std::vector<uint32_t> surface = std::vector<uint32_t>(kPixels);
};

TEST(Features, TilesShowWhatSinglePixelsShow) {
  for (const char* name : {"cornell-mirror", "mine"}) {
    const CompiledScene scene(find_builtin_scene(name)->build(), CompileOptions{.width = kWidth, .height = kHeight});
    std::vector<Hit> hits(kPixels);
    const PrimaryHitsKernel primary{scene.view().accel, scene.view().camera, FeatureBuffers::kIndex,
                                    mutable_view_of(hits), kWidth};
    FeatureBuffers single;
    FeatureBuffers tiles;
    const FeatureKernel one = single.kernel(scene, hits);
    FeatureKernel many = tiles.kernel(scene, hits);
    many.camera_moved = false;
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x) {
        primary(x, y);
        one(x, y);
      }
    }
    many(Tile{0, 0, kWidth, kHeight});
    EXPECT_EQ(single.position, tiles.position);
    EXPECT_EQ(single.previous, tiles.previous);
    EXPECT_EQ(single.normal, tiles.normal);
    EXPECT_EQ(single.albedo, tiles.albedo);
    EXPECT_EQ(single.emission, tiles.emission);
    EXPECT_EQ(single.depth, tiles.depth);
    EXPECT_EQ(single.surface, tiles.surface);
    EXPECT_EQ(single.motion, tiles.motion);  // none, whether it is computed or known
  }
}

TEST(Features, DemodulationDividesByTheAlbedo) {
  const Rgb light = demodulate(Rgb(0.4f, 0.3f, 0.1f), Rgb(0.1f, 0, 0), Rgb(0.5f, 0.25f, 0));
  EXPECT_NEAR(light.r, 0.6f, 1e-6f);
  EXPECT_NEAR(light.g, 1.2f, 1e-6f);
  EXPECT_NEAR(light.b, 1.2f, 1e-6f);  // says nothing: takes the largest
  EXPECT_FALSE(is_filtered(Rgb(0)));
  EXPECT_TRUE(is_filtered(Rgb(0, 0.5f, 0)));
}

TEST(Features, LobesThatMirrorAreFollowed) {
  const CompiledScene scene(find_builtin_scene("cornell")->build(), CompileOptions{.width = 8, .height = 8});
  SurfacePoint sp;
  sp.ng = sp.ns = Vec3(0, 0, 1);
  sp.frame = make_frame(sp.ng);
  sp.wo_local = glm::normalize(Vec3(0.3f, 0.2f, 1.0f));
  sp.wo = sp.frame.to_world(sp.wo_local);
  const auto step_of = [&](const MaterialSample& sample, const MaterialData& material) {
    make_bsdf(sp.bsdf, sample, material, *scene.view().energy_tables, sp.wo_local.z, true);
    return narrow_step(sp);
  };
  MaterialData material{};
  material.ior = 1.5f;
  MaterialSample metal;
  metal.metallic = 1;
  metal.roughness = 0;
  const NarrowStep mirrored = step_of(metal, material);
  ASSERT_TRUE(mirrored.valid);
  EXPECT_TRUE(mirrored.reflected);
  EXPECT_NEAR(glm::dot(mirrored.wi, sp.frame.n), sp.wo_local.z, 1e-5f);
  metal.roughness = 0.05f;  // α = 0.0025
  EXPECT_TRUE(step_of(metal, material).valid);
  metal.roughness = 0.3f;
  EXPECT_FALSE(step_of(metal, material).valid);
  MaterialSample plastic;
  plastic.roughness = 0;  // mirrors a twentieth; most is diffuse
  EXPECT_FALSE(step_of(plastic, material).valid);
  MaterialSample window;
  window.roughness = 0;
  window.transmission = 1;
  const NarrowStep straight = step_of(window, material);  // no volume: a thin wall
  ASSERT_TRUE(straight.valid);
  EXPECT_NEAR(glm::dot(straight.wi, sp.wo), -1.0f, 1e-5f);
  EXPECT_LT(straight.emission.r, 1.0f);
}

/// Pictures of a gradient with noise.
struct Pictures {
  void average(bool still, float newest) {
    PictureHistoryKernel kernel;
    kernel.shown = view_of(shown);
    kernel.before = view_of(before);
    kernel.motion = view_of(motion);
    kernel.albedo = view_of(albedo);
    kernel.emission = view_of(emission);
    kernel.unfiltered = mutable_view_of(unfiltered);
    kernel.picture = mutable_view_of(picture);
    kernel.newest = newest;
    kernel.filtered_share = mutable_view_of(filtered_share);
    kernel.frames = frames;
    kernel.still = still;
    kernel.width = kWidth;
    kernel.height = kHeight;
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x) kernel(x, y);
    }
  }
  ConvergeKernel converge() {
    return {view_of(before), view_of(shown), view_of(m2), view_of(samples), mutable_view_of(picture),
            false,           true,           kWidth,      kHeight};
  }

  std::vector<Rgb> shown = std::vector<Rgb>(kPixels, Rgb(1));
  std::vector<Rgb> before = std::vector<Rgb>(kPixels, Rgb(3));
  std::vector<Rgb> picture = std::vector<Rgb>(kPixels);
  std::vector<Rgb> albedo = std::vector<Rgb>(kPixels, Rgb(0.5f));
  std::vector<Rgb> emission = std::vector<Rgb>(kPixels, Rgb(0));
  std::vector<Rgb> unfiltered = std::vector<Rgb>(kPixels, Rgb(0));
  std::vector<float> filtered_share = std::vector<float>(kPixels, 1.0f);
  uint32_t frames = 1;
  std::vector<Vec2> motion = std::vector<Vec2>(kPixels, Vec2(0));
  std::vector<float> m2 = std::vector<float>(kPixels, 0.0f);
  std::vector<uint32_t> samples = std::vector<uint32_t>(kPixels, 16);
};

TEST(PictureHistory, LaterPicturesWeighMore) {
  Pictures p;
  p.frames = 7;
  p.average(true, 0.2f);
  EXPECT_EQ(p.picture[7], Rgb(2.5f));  // a quarter
}

TEST(PictureHistory, WhatIsNotFilteredCountsAlikeInEveryFrame) {
  // In every third of twelve frames pixel 0 sees a lamp, pixel 1 the same beside an albedo, pixel 2 a sky as bright as
  // the wall; what is filtered grows by one a frame but for pixel 2.
  Pictures p;
  const double parts[] = {1, 2, 4, 5, 7, 8, 10, 11};
  double sum_of_wall = 0;
  for (int k = 0; k < 8; ++k) sum_of_wall += (k + 1) * parts[k] / 36;
  double sum_of_all = 0;
  for (int i = 0; i < 12; ++i) {
    const bool lamp = i % 3 == 0;
    const Rgb part(static_cast<float>(i));
    p.albedo[0] = p.albedo[2] = Rgb(lamp ? 0.0f : 0.5f);
    p.shown[0] = lamp ? Rgb(30) : part;
    p.emission[1] = Rgb(lamp ? 30.0f : 0.0f);
    p.shown[1] = part + p.emission[1];
    p.shown[2] = Rgb(3);
    p.frames = static_cast<uint32_t>(i + 1);
    p.average(i > 0, i > 0 ? 0.2f : 1.0f);
    sum_of_all += (i + 1) * i / 78.0;
    p.before = p.picture;
    EXPECT_NEAR(p.picture[2].r, 3, 1e-4) << i;
  }
  EXPECT_NEAR(p.picture[0].r, 10 + sum_of_wall * 2 / 3, 1e-4);
  EXPECT_NEAR(p.picture[1].r, 10 + sum_of_all, 1e-4);
}

TEST(PictureHistory, IsNoDarkerThanBlackWhereSamplesMissTheLampThatIsSeen) {
  Pictures p;
  for (int i = 0; i < 4; ++i) {
    const bool lamp = i > 0;  // at its edge in a mirror: from then on features say so, and samples find nothing
    p.emission[0] = Rgb(lamp ? 18.0f : 0.0f);
    p.shown[0] = Rgb(lamp ? 0.0f : 5.0f);
    p.frames = static_cast<uint32_t>(i + 1);
    p.average(i > 0, i > 0 ? 0.2f : 1.0f);
    p.before = p.picture;
    EXPECT_GE(p.picture[0].r, 0) << i;
  }
  EXPECT_EQ(p.picture[0], Rgb(0));
}

TEST(PictureHistory, MovedPicturesAreHeldToWhatIsSeenNow) {
  Pictures p;
  p.average(false, 0.25f);
  EXPECT_EQ(p.picture[7], Rgb(1));  // 3 is beyond anything around
}

TEST(PictureHistory, MotionIsFollowedWithoutBlur) {
  Pictures p;
  const auto wave = [](float x) { return Rgb(2.0f + std::sin(0.5f * x)); };
  for (uint32_t i = 0; i < kPixels; ++i) {
    const auto x = static_cast<float>(i % kWidth);
    p.before[i] = wave(x);
    p.motion[i] = Vec2(2.5f, 0);
    p.shown[i] = Rgb(i % 2 == 0 ? 0.0f : 4.0f);  // holds nothing back
  }
  p.average(false, 1e-6f);
  for (uint32_t x = 6; x < kWidth - 6; ++x)
    EXPECT_NEAR(p.picture[20 * kWidth + x].r, wave(static_cast<float>(x) - 2.5f).r, 0.01f);
}

TEST(PictureHistory, ConvergesToTheMeanAsFarAsThatIsKnown) {
  Pictures p;  // the picture is off by 2
  const ConvergeKernel kernel = p.converge();
  kernel(20, 20);
  EXPECT_EQ(p.picture[20 * kWidth + 20], Rgb(1));
  p.m2.assign(kPixels, 2.0f * 16 * 15);  // the mean's variance is half of the squared difference
  kernel(20, 20);
  EXPECT_NEAR(p.picture[20 * kWidth + 20].r, 2.0f, 1e-5f);
  p.m2.assign(kPixels, 9.0f * 16 * 15);
  kernel(20, 20);
  EXPECT_EQ(p.picture[20 * kWidth + 20], Rgb(3));
  p.m2.assign(kPixels, 0.0f);
  p.samples.assign(kPixels, 2);  // nobody knows
  kernel(20, 20);
  EXPECT_EQ(p.picture[20 * kWidth + 20], Rgb(3));
}

TEST(PictureHistory, ALonelyBrightSampleStaysFiltered) {
  Pictures p;  // black but for one sample of 160 in one pixel
  constexpr uint32_t kPixel = 20 * kWidth + 20;
  p.before.assign(kPixels, Rgb(0));
  p.shown.assign(kPixels, Rgb(0));
  p.shown[kPixel] = Rgb(10);
  p.m2[kPixel] = 160.0f * 160 * (1 - 1 / 16.0f);
  ConvergeKernel kernel = p.converge();
  kernel.stratified = true;
  kernel(20, 20);
  EXPECT_NEAR(p.picture[kPixel].r, 0.0f, 1e-3f);
}

TEST(PictureHistory, TilesConvergeAsSinglePixelsDo) {
  Pictures p;
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> uniform(0, 2);
  for (uint32_t i = 0; i < kPixels; ++i) {
    p.shown[i] = Rgb(uniform(generator), uniform(generator), 1);
    p.before[i] = Rgb(1);
    p.m2[i] = 40.0f * uniform(generator);
    p.samples[i] = i % 40 + 2;
  }
  ConvergeKernel kernel = p.converge();
  kernel.stratified = true;
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) kernel(x, y);
  }
  const std::vector<Rgb> single = p.picture;
  for (uint32_t y = 0; y < kHeight; y += kTileSize) {
    for (uint32_t x = 0; x < kWidth; x += kTileSize)
      kernel(Tile{x, y, std::min(x + kTileSize, kWidth), std::min(y + kTileSize, kHeight)});
  }
  EXPECT_EQ(std::memcmp(single.data(), p.picture.data(), kPixels * sizeof(Rgb)), 0);
}

}  // namespace
}  // namespace relume

#include "techniques/gbuffer/features/features.h"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "scene/compiled_scene.h"
#include "scene/testing/media.h"
#include "techniques/denoise/shared/denoiser_buffers.h"
#include "techniques/gbuffer/features/features_pass.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 45;
constexpr uint32_t kHeight = 37;
constexpr uint32_t kPixels = kWidth * kHeight;

/// One frame of a scene, with features.
struct Frame {
  Frame(Scene scene, int max_bounces, EstimatorChoice estimator = EstimatorChoice::path)
      : session(std::move(scene), settings(max_bounces, estimator)) {
    session.render_frame();
  }
  Frame(const char* scene, int max_bounces, EstimatorChoice estimator = EstimatorChoice::path)
      : Frame(find_builtin_scene(scene)->build(), max_bounces, estimator) {}

  static RenderSettings settings(int max_bounces, EstimatorChoice estimator) {
    RenderSettings s;
    s.width = kWidth;
    s.height = kHeight;
    s.threads = 1;
    s.path.max_bounces = max_bounces;
    s.path.russian_roulette = false;
    s.estimator = estimator;
    s.denoise = DenoiseChoice::svgf;  // requires features
    return s;
  }

  template <typename T>
  View<const T> view(const BufferKey<T>& key) const {
    return buffer_table(session).view(key);
  }
  /// Whether the surface is seen in a mirror or through an interface.
  bool indirect(uint32_t pixel) const { return view(kFeature.surface)[pixel] != view(kPrimaryHits)[pixel].instance; }

  Session session;
};

TEST(Features, AMirrorIsAWindow) {
  const Frame frame("cornell-mirror", 8);
  const float mirror_z = -2.75f;
  const uint32_t mirror = frame.view(kPrimaryHits)[12 * kWidth + 22].instance;
  const uint32_t instances = 16;  // upper bound
  int seen = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    // Seen through this mirror only.
    const uint32_t instance = frame.view(kFeature.surface)[i] ^ hash(mirror, 1u);
    const bool on_a_wall = max_component(abs(frame.view(kFeature.normal)[i])) > 0.999f;
    if (frame.view(kPrimaryHits)[i].instance != mirror || instance >= instances || !on_a_wall) continue;
    // Mirrored back, the position lies on a wall of the room.
    Vec3 p = frame.view(kFeature.position)[i];
    ASSERT_LT(p.z, mirror_z);
    p.z = 2.0f * mirror_z - p.z;
    const float off = relume::min(relume::min(std::fabs(std::fabs(p.x) - 2.75f), std::fabs(p.z - 11.0f)),
                                  relume::min(std::fabs(p.y), std::fabs(p.y - 5.5f)));
    EXPECT_LT(off, 0.011f) << i;  // the lamp hangs 1 cm below the ceiling
    EXPECT_GT(frame.view(kFeature.depth)[i], frame.view(kPrimaryHits)[i].t);
    EXPECT_EQ(frame.view(kFeature.motion)[i], Vec2(0));
    ++seen;
  }
  EXPECT_GT(seen, 200);
}

TEST(Features, MirroredEmissionMatchesPaths) {
  const Frame frame("cornell-mirror", 1);  // one mirror, then emission only
  int lamps = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (!frame.indirect(i)) continue;
    const Rgb radiance = frame.view(kRadiance)[i];
    const Rgb emission = frame.view(kShownEmission)[i];
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
    EXPECT_GT(frame.view(kFeature.depth)[i], frame.view(kPrimaryHits)[i].t);
    ++through;
  }
  EXPECT_GT(through, 50);
}

const Rgb kAbsorption(0.2f, 0.5f, 1.0f);

/// Checks that `metres` of a medium attenuate emission and albedo of a white plate as they attenuate paths.
void expect_seen_through(const Scene& glowing, float metres, const char* what) {
  const Frame glow(glowing, 8);
  Scene reflecting = glowing;
  reflecting.materials[0].unlit = false;
  const Frame plate(reflecting, 8);
  for (uint32_t i = 0; i < kPixels; ++i) {
    const Rgb radiance = glow.view(kRadiance)[i];
    const Rgb emission = glow.view(kFeatureEmission)[i];
    const Rgb albedo = plate.view(kFeatureAlbedo)[i];
    for (int c = 0; c < 3; ++c) {
      const float share = std::exp(-kAbsorption[c] * metres);
      ASSERT_NEAR(radiance[c], share, 1e-4f) << what;
      ASSERT_NEAR(emission[c], share, 1e-4f) << what;
      ASSERT_NEAR(albedo[c], share, 1e-4f) << what;
    }
  }
}

TEST(Features, MediaAbsorbLikePaths) {
  Scene behind = testing::glowing_plate(5);
  testing::add_slab(behind, testing::tint(kAbsorption), 3, 1);
  expect_seen_through(behind, 2, "the plate behind a medium");
  Scene inside = testing::glowing_plate(5);
  testing::add_slab(inside, testing::tint(kAbsorption), 3, -1);
  expect_seen_through(inside, 3, "the plate in a medium");
  Scene eye_inside = testing::glowing_plate(2);
  testing::add_slab(eye_inside, testing::tint(kAbsorption), 3, 0.5f);
  expect_seen_through(eye_inside, 1.5f, "the camera in a medium");
  Scene all_inside = testing::glowing_plate(2);
  testing::add_slab(all_inside, testing::tint(kAbsorption), 3, -1);
  expect_seen_through(all_inside, 2, "camera and plate in a medium");
  Scene nested = testing::glowing_plate(5);
  testing::add_slab(nested, testing::tint(kAbsorption * 0.5f), 4, -1);
  testing::add_slab(nested, testing::tint(kAbsorption), 3, 2);
  expect_seen_through(nested, 2 + 1, "a medium in a medium");
}

TEST(Features, DirectSurfacesAreTheFirstHits) {
  const Frame frame("cornell", 8);
  for (uint32_t i = 0; i < kPixels; ++i) {
    const Hit hit = frame.view(kPrimaryHits)[i];
    if (!hit.valid()) continue;
    EXPECT_FALSE(frame.indirect(i));
    EXPECT_EQ(frame.view(kFeature.depth)[i], hit.t);
    EXPECT_NEAR(glm::length(frame.view(kFeature.normal)[i]), 1.0f, 1e-5f);
    EXPECT_LE(max_component(frame.view(kFeatureAlbedo)[i]), 1.0f);
  }
}

TEST(Features, TheBackgroundIsEmission) {
  const Frame frame("mine", 8);
  int background = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (frame.view(kPrimaryHits)[i].valid()) continue;
    EXPECT_EQ(frame.view(kFeatureAlbedo)[i], Rgb(0));
    EXPECT_EQ(frame.view(kShownEmission)[i], frame.view(kRadiance)[i]);
    EXPECT_EQ(frame.view(kScattered)[i], Rgb(0));
    EXPECT_EQ(frame.view(kFeature.surface)[i], kNoSurface);
    ++background;
  }
  EXPECT_GT(background, 0);
}

TEST(Features, LightTracingSeesNothingInMirrors) {
  const Frame frame("cornell-mirror", 8, EstimatorChoice::light);
  for (uint32_t i = 0; i < kPixels; ++i) EXPECT_FALSE(frame.indirect(i));
}

/// The buffers that FeatureKernel writes.
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

  static constexpr SampleIndex kIndex{.seed = 3, .sample = 5};
  std::vector<Vec3> position = std::vector<Vec3>(kPixels);
  std::vector<Vec3> previous = position;
  std::vector<Vec3> normal = position;
  std::vector<Rgb> albedo = position;
  std::vector<Rgb> emission = position;
  std::vector<float> depth = std::vector<float>(kPixels);
  std::vector<Vec2> motion = std::vector<Vec2>(kPixels);
  std::vector<uint32_t> surface = std::vector<uint32_t>(kPixels);
};

TEST(Features, TilesMatchSinglePixels) {
  for (const char* name : {"cornell-mirror", "mine"}) {
    const CompiledScene scene(find_builtin_scene(name)->build(), CompileOptions{.width = kWidth, .height = kHeight});
    std::vector<Hit> hits(kPixels);
    const PrimaryHitsKernel primary{scene.view(), FeatureBuffers::kIndex, mutable_view_of(hits), {}, kWidth};
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
    EXPECT_EQ(single.motion, tiles.motion);  // zero, whether computed or skipped
  }
}

/// Two frames of a scene, the second after a step of the camera. `observed`: a hook may read features after their pass.
std::unique_ptr<Session> walked(const Scene& scene, const RenderSettings& settings, bool observed) {
  auto session = std::make_unique<Session>(scene, settings);
  if (observed) session->on_pass([](const std::string&) {});
  session->render_frame();
  CameraPose camera = session->camera();
  camera.to_world = camera.to_world * glm::translate(Mat4(1), Vec3(0.05f, 0.02f, -0.1f));
  session->set_camera(camera);
  session->render_frame();
  return session;
}

template <typename T>
void expect_equal(const Session& a, const Session& b, const BufferKey<T>& key) {
  const View<const T> of_a = buffer_table(a).view(key);
  const View<const T> of_b = buffer_table(b).view(key);
  ASSERT_EQ(of_a.size, kPixels) << key.name;
  ASSERT_EQ(of_b.size, kPixels) << key.name;
  EXPECT_EQ(std::memcmp(of_a.data, of_b.data, kPixels * sizeof(T)), 0) << key.name;
}

/// Built-in scenes, one of them a second time with dispersive glass.
std::vector<Scene> varied_scenes() {
  std::vector<Scene> scenes;
  for (const char* name : {"cornell-mirror", "cornell-glass", "mine", "warehouse", "cornell-glass"})
    scenes.push_back(find_builtin_scene(name)->build());
  for (Camera& camera : scenes[3].cameras) camera.lens_radius = 0.05f;
  for (Material& material : scenes.back().materials) material.dispersion = 5;
  return scenes;
}

void expect_equal_features(const Session& a, const Session& b, bool split) {
  expect_equal(a, b, kPrimaryHits);
  expect_equal(a, b, kFeature.position);
  expect_equal(a, b, kFeature.previous);
  expect_equal(a, b, kFeature.normal);
  expect_equal(a, b, kFeatureAlbedo);
  expect_equal(a, b, kFeatureEmission);
  expect_equal(a, b, kFeature.depth);
  expect_equal(a, b, kFeature.motion);
  expect_equal(a, b, kFeature.surface);
  if (!split) return;
  expect_equal(a, b, kDiffuseAlbedo);
  expect_equal(a, b, kSpecularAlbedo);
  expect_equal(a, b, kReflection.position);
  expect_equal(a, b, kReflection.previous);
  expect_equal(a, b, kReflection.normal);
  expect_equal(a, b, kReflection.depth);
  expect_equal(a, b, kReflection.motion);
}

/// Whether the pass of features has evaluated surfaces.
bool evaluates_features(const Session& session) {
  const std::vector<PassTime> passes = session.statistics().passes;
  return std::any_of(passes.begin(), passes.end(), [](const PassTime& pass) { return pass.name == "features"; });
}

TEST(Features, PathsAndPassGiveTheSameFeatures) {
  RenderSettings split = Frame::settings(8, EstimatorChoice::path);
  RenderSettings whole = split;
  whole.features.split = false;
  whole.path.max_bounces = 0;
  whole.lights = LightSelectionChoice::vlc;
  const std::vector<Scene> scenes = varied_scenes();
  for (size_t i = 0; i < scenes.size(); ++i) {
    for (const RenderSettings& settings : {split, whole}) {
      SCOPED_TRACE(::testing::Message() << "scene " << i << ", " << settings.path.max_bounces << " bounces");
      const auto from_paths = walked(scenes[i], settings, false);
      const auto from_pass = walked(scenes[i], settings, true);
      EXPECT_EQ(evaluates_features(*from_paths), i + 1 == scenes.size()) << "dispersive";
      EXPECT_TRUE(evaluates_features(*from_pass));
      expect_equal_features(*from_paths, *from_pass, settings.features.split);
    }
  }
}

TEST(Features, ThePassEvaluatesThemIfAHistoryReadsThem) {
  RenderSettings settings = Frame::settings(8, EstimatorChoice::path);
  settings.history = HistoryChoice::reproject;
  settings.reproject.method = ReprojectionMethod::backward;
  Session session(find_builtin_scene("cornell")->build(), settings);
  session.render_frame();
  EXPECT_TRUE(evaluates_features(session));
  settings.features.split = false;
  Session whole(find_builtin_scene("cornell")->build(), settings);
  whole.render_frame();
  EXPECT_FALSE(evaluates_features(whole));
}

TEST(Features, DemodulationDividesByTheAlbedo) {
  const Rgb light = light_at_surface(Rgb(0.3f, 0.3f, 0.1f), Rgb(0.5f, 0.25f, 0));
  EXPECT_NEAR(light.r, 0.6f, 1e-6f);
  EXPECT_NEAR(light.g, 1.2f, 1e-6f);
  EXPECT_NEAR(light.b, 1.2f, 1e-6f);  // black albedo: takes the largest
  EXPECT_FALSE(is_filtered(Rgb(0)));
  EXPECT_TRUE(is_filtered(Rgb(0, 0.5f, 0)));
}

TEST(Features, MirrorLobesAreFollowed) {
  const CompiledScene scene(find_builtin_scene("cornell")->build(), CompileOptions{.width = 8, .height = 8});
  SurfacePoint sp;
  sp.ng = sp.ns = Vec3(0, 0, 1);
  sp.frame = make_frame(sp.ng);
  sp.wo_local = glm::normalize(Vec3(0.3f, 0.2f, 1.0f));
  sp.wo = sp.frame.to_world(sp.wo_local);
  const auto step_of = [&](const MaterialSample& sample, const MaterialData& material) {
    make_bsdf(sp.bsdf, sample, material, scene.view().energy_tables, sp.wo_local.z, true);
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
  metal.roughness = 0;
  metal.clearcoat = 1;
  metal.clearcoat_roughness = 0.3f;
  sp.wo_local = glm::normalize(Vec3(1.0f, 0.2f, 0.3f));
  sp.wo = sp.frame.to_world(sp.wo_local);
  const NarrowStep below_coat = step_of(metal, material);
  ASSERT_TRUE(below_coat.valid);
  Rgb returned(0);  // of a lamp in that direction
  constexpr int kSamples = 4096;
  for (int i = 0; i < kSamples; ++i) {
    const float u = (static_cast<float>(i) + 0.5f) / kSamples;
    const BsdfSample s = sample(sp.bsdf, sp.wo_local, u, Vec2(0.5f), TransportMode::radiance);
    if (s.valid && s.delta) returned += s.weight / static_cast<float>(kSamples);
  }
  EXPECT_LT(returned.g, 0.9f);
  EXPECT_NEAR(below_coat.emission.g / returned.g, 1.0f, 1e-3f);
  MaterialSample plastic;
  plastic.roughness = 0;  // reflects 1/20 specularly; most is diffuse
  EXPECT_FALSE(step_of(plastic, material).valid);
  MaterialSample window;
  window.roughness = 0;
  window.transmission = 1;
  const NarrowStep straight = step_of(window, material);  // no volume: a thin wall
  ASSERT_TRUE(straight.valid);
  EXPECT_NEAR(glm::dot(straight.wi, sp.wo), -1.0f, 1e-5f);
  EXPECT_LT(straight.emission.r, 1.0f);
}

}  // namespace
}  // namespace relume

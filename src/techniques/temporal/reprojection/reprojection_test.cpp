#include "techniques/temporal/reprojection/reprojection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "builtin_scenes/builtin.h"
#include "framebuffer/testing/moment_vectors.h"
#include "scene/compiled_scene.h"

namespace relume {
namespace {

constexpr uint32_t kSize = 24;
constexpr uint32_t kPixels = kSize * kSize;

/// A scene and the buffers of one frame.
struct Stage {
  explicit Stage(Scene source, std::vector<Index> movable = {})
      : scene(std::move(source), {.width = kSize, .height = kSize, .movable = std::move(movable)}) {}

  /// Moves the camera to its right, in metres.
  void shift_camera(float distance) {
    CameraPose camera = scene.camera();
    camera.to_world[3] += distance * camera.to_world[0];
    scene.set_camera(camera);
  }

  /// Turns the camera about the vertical axis, in radians.
  void turn_camera(float angle) {
    CameraPose camera = scene.camera();
    camera.to_world = glm::rotate(camera.to_world, angle, Vec3(0, 1, 0));
    scene.set_camera(camera);
  }

  void render() {
    std::fill(hits.begin(), hits.end(), Hit{});
    const SampleIndex index{.seed = 1, .sample = 3};
    const PrimaryHitsKernel primary{scene.view(), index, mutable_view_of(hits), {}, kSize};
    PathKernel<RadianceOutput, FirstVertexOutput> kernel;
    kernel.context.scene = scene.view();
    kernel.context.selector.kind = LightSelectorKind::uniform;
    kernel.context.selector.uniform = make_uniform_lights(scene.view().lights);
    kernel.context.max_bounces = 2;
    kernel.index = index;
    kernel.hits = view_of(hits);
    kernel.rays = mutable_view_of(rays);
    kernel.width = kSize;
    kernel.outputs =
        path_outputs(RadianceOutput{mutable_view_of(radiance)}, FirstVertexOutput{mutable_view_of(vertices)});
    StoreKernel store;
    store.hits = view_of(hits);
    store.first_vertices = view_of(vertices);
    store.radiance = view_of(radiance);
    store.history = history.mutable_view();
    store.scene = scene.view();
    store.stored = mutable_view_of(stored);
    store.pixels = mutable_view_of(pixels);
    store.max_distance = 0.02f;
    store.width = kSize;
    for (uint32_t y = 0; y < kSize; ++y) {
      for (uint32_t x = 0; x < kSize; ++x) {
        primary(x, y);
        kernel(x, y);
        store(x, y);
      }
    }
    scene.end_frame();
  }

  void vote(float max_error, bool lights_changed) {
    std::fill(votes.begin(), votes.end(), kNoVote);
    DepthVoteKernel kernel;
    kernel.scene = scene.view();
    kernel.stored = view_of(stored);
    kernel.pixels = view_of(pixels);
    kernel.votes = mutable_view_of(votes);
    kernel.reject_reasons = mutable_view_of(reject_reasons);
    kernel.max_error = max_error;
    kernel.max_light_error = max_error;
    kernel.lights_changed = lights_changed;
    kernel.mean = view_of(radiance);
    kernel.limits = mutable_view_of(limits);
    kernel.max_samples_changed = 16;
    kernel.width = kSize;
    for (uint32_t y = 0; y < kSize; ++y) {
      for (uint32_t x = 0; x < kSize; ++x) kernel(x, y);
    }
  }

  int count(RejectReason reject_reason) const {
    return static_cast<int>(
        std::count(reject_reasons.begin(), reject_reasons.end(), static_cast<uint32_t>(reject_reason)));
  }

  CompiledScene scene;
  std::vector<Hit> hits = std::vector<Hit>(kPixels);
  std::vector<FirstVertex> vertices = std::vector<FirstVertex>(kPixels);
  std::vector<Rgb> radiance = std::vector<Rgb>(kPixels);
  std::vector<uint32_t> rays = std::vector<uint32_t>(kPixels);
  testing::MomentVectors history{kPixels};
  std::vector<StoredSample> stored = std::vector<StoredSample>(kPixels);
  std::vector<StoredPixel> pixels = std::vector<StoredPixel>(kPixels);
  std::vector<uint64_t> votes = std::vector<uint64_t>(kPixels);
  std::vector<uint32_t> reject_reasons = std::vector<uint32_t>(kPixels);
  std::vector<uint32_t> limits = std::vector<uint32_t>(kPixels);
};

Scene cornell() { return find_builtin_scene("cornell")->build(); }

/// The Cornell box, with one roughness and metalness for all materials.
Scene cornell_of(float roughness, float metallic) {
  Scene scene = cornell();
  for (Material& m : scene.materials) {
    m.roughness = roughness;
    m.metallic = metallic;
  }
  return scene;
}

TEST(Reprojection, AStillCameraVotesForItsOwnPixels) {
  Stage stage(cornell());
  stage.render();
  stage.vote(1e-4f, false);
  int surfaces = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (!stage.hits[i].valid() || max_component(stage.radiance[i]) > 5.0f) continue;  // the lamp reflects nothing
    ++surfaces;
    EXPECT_EQ(static_cast<RejectReason>(stage.reject_reasons[i]), RejectReason::none) << i;
    EXPECT_EQ(static_cast<uint32_t>(stage.votes[i]), i);
  }
  EXPECT_GT(surfaces, static_cast<int>(kPixels) / 2);
}

TEST(Reprojection, MovesToTheNewPixelOfTheSurface) {
  Stage stage(cornell());
  stage.render();
  stage.shift_camera(0.3f);
  stage.vote(10.0f, false);
  EXPECT_GT(stage.count(RejectReason::none), static_cast<int>(kPixels) / 3);
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (!is_vote(stage.votes[i])) continue;
    const auto source = static_cast<uint32_t>(stage.votes[i]);
    const Vec3 p = surface_position(stage.scene.view(), stage.stored[source].hit).now;
    Vec2 raster;
    const CameraView& view = stage.scene.view().camera;
    ASSERT_TRUE(raster_position(view, {view.position, glm::normalize(p - view.position), kInfinity}, &raster));
    EXPECT_EQ(static_cast<uint32_t>(raster.y) * kSize + static_cast<uint32_t>(raster.x), i);
  }
}

TEST(Reprojection, LeavesTheScreenWhenTheCameraTurnsAway) {
  Stage stage(cornell());
  stage.render();
  stage.turn_camera(kPi);
  stage.vote(10.0f, false);
  EXPECT_EQ(stage.count(RejectReason::none), 0);
  EXPECT_GT(stage.count(RejectReason::off_screen), 0);
}

TEST(Reprojection, DetectsOcclusion) {
  // From the right, the tall box hides a part of the back wall that was visible.
  Stage stage(cornell());
  stage.render();
  stage.shift_camera(1.2f);
  stage.vote(10.0f, false);
  EXPECT_GT(stage.count(RejectReason::occluded), 0);
}

TEST(Reprojection, MirrorsAreRejectedIfTheCameraMoves) {
  Stage stage(cornell_of(0.05f, 1.0f));  // α = 0.0025
  stage.render();
  stage.shift_camera(0.01f);
  stage.vote(10.0f, false);
  EXPECT_EQ(stage.count(RejectReason::none), 0);
  EXPECT_GT(stage.count(RejectReason::near_specular), 0);
}

TEST(Reprojection, MirrorsAreKeptIfOnlyTheCameraTurns) {
  Stage stage(cornell_of(0.05f, 1.0f));
  stage.render();
  stage.turn_camera(0.1f);
  stage.vote(0.0f, false);
  EXPECT_EQ(stage.count(RejectReason::near_specular), 0);
  EXPECT_GT(stage.count(RejectReason::none), static_cast<int>(kPixels) / 3);
  stage.vote(10.0f, true);  // mirrored objects may have moved
  EXPECT_EQ(stage.count(RejectReason::none), 0);
}

// The paper rejects materials, not lobes.
TEST(Reprojection, SmoothCoatsRejectTheBaseToo) {
  Scene scene = cornell_of(0.05f, 0.0f);
  for (Material& m : scene.materials) m.specular = 1.0f;
  Stage stage(std::move(scene));
  stage.render();
  stage.shift_camera(0.01f);
  stage.vote(10.0f, false);
  EXPECT_EQ(stage.count(RejectReason::none), 0);
  EXPECT_GT(stage.count(RejectReason::near_specular), static_cast<int>(kPixels) / 2);
}

TEST(Reprojection, PixelsWithoutAHistoryHaveAReason) {
  const auto reasons = [](Stage& stage, RejectReason reason) {
    return std::count_if(stage.votes.begin(), stage.votes.end(), [&](uint64_t c) { return reason_of(c) == reason; });
  };
  Stage mirrors(cornell_of(0.05f, 1.0f));
  mirrors.render();
  mirrors.shift_camera(0.01f);
  mirrors.vote(10.0f, false);
  const int refused = mirrors.count(RejectReason::near_specular);
  EXPECT_LE(reasons(mirrors, RejectReason::near_specular), refused);  // two rejections may share a pixel
  EXPECT_GT(reasons(mirrors, RejectReason::near_specular), refused * 9 / 10);
  // From the right, the tall box hides a part of the back wall that was visible.
  Stage stage(cornell());
  stage.render();
  stage.shift_camera(1.2f);
  stage.vote(10.0f, false);
  EXPECT_GT(reasons(stage, RejectReason::none), 0);
  EXPECT_GT(reasons(stage, RejectReason::occluded), 0);
  EXPECT_GT(reasons(stage, RejectReason::empty), 0);
  EXPECT_EQ(reasons(stage, RejectReason::off_screen), 0);
}

TEST(Reprojection, RejectsGlossThatWouldLookDifferent) {
  const auto refused = [](float roughness, float max_error) {
    Stage stage(cornell_of(roughness, 1.0f));
    stage.render();
    stage.shift_camera(0.5f);
    stage.vote(max_error, false);
    return stage.count(RejectReason::view_dependent);
  };
  EXPECT_GT(refused(0.3f, 1.0f / 256.0f), refused(0.3f, 0.25f));
  EXPECT_GT(refused(0.3f, 1.0f / 256.0f), refused(1.0f, 1.0f / 256.0f));
}

TEST(Reprojection, GlossFromCellsIsLookedUpUnlessThePixelShowsSeveralSurfaces) {
  Stage stage(cornell_of(0.3f, 1.0f));
  stage.render();
  stage.shift_camera(0.5f);
  const auto counts_with = [&](uint16_t cells, uint16_t mixed) {
    for (StoredPixel& pixel : stage.pixels) {
      pixel.cells = cells;
      pixel.mixed = mixed;
    }
    stage.vote(1.0f / 256.0f, false);
    return std::vector<int>{stage.count(RejectReason::view_dependent), stage.count(RejectReason::looked_up)};
  };
  const std::vector<int> without = counts_with(0, 0);
  const std::vector<int> looked_up = counts_with(1, 0);
  EXPECT_GT(without[0], 20);
  EXPECT_EQ(without[1], 0);
  EXPECT_EQ(looked_up[0], 0);
  EXPECT_GT(looked_up[1], 20);
  EXPECT_LE(looked_up[1], without[0]);  // some of them are occluded
  EXPECT_EQ(counts_with(1, 1), without);
}

TEST(Reprojection, GlossIsKeptIfOnlyTheCameraTurns) {
  Stage stage(cornell_of(0.3f, 1.0f));
  stage.render();
  stage.turn_camera(0.1f);
  stage.vote(0.0f, false);
  EXPECT_EQ(stage.count(RejectReason::view_dependent), 0);
  EXPECT_GT(stage.count(RejectReason::none), static_cast<int>(kPixels) / 3);
}

TEST(Reprojection, AHighlightDoesNotTurnWithItsObject) {
  const auto refused = [](float degrees) {
    Scene scene = cornell_of(0.3f, 1.0f);
    const auto box =
        std::find_if(scene.nodes.begin(), scene.nodes.end(), [](const Node& n) { return n.name == "tall box"; });
    const auto node = static_cast<Index>(box - scene.nodes.begin());
    Stage stage(std::move(scene), {node});
    stage.render();
    Transform turned = stage.scene.source().nodes[static_cast<size_t>(node)].transform;
    turned.rotation = glm::angleAxis(glm::radians(degrees), Vec3(0, 1, 0)) * turned.rotation;
    stage.scene.set_transform(node, turned);
    stage.vote(1.0f / 256.0f, false);
    return stage.count(RejectReason::view_dependent);
  };
  EXPECT_EQ(refused(0), 0);
  EXPECT_GE(refused(20), 5);  // of some dozen pixels of the box; none without the turn of its frame
}

TEST(Reprojection, LambertNeverDependsOnTheView) {
  Scene scene = cornell_of(1.0f, 0.0f);
  for (Material& m : scene.materials) m.specular = 0.0f;
  Stage stage(std::move(scene));
  stage.render();
  stage.shift_camera(0.5f);
  stage.vote(1e-6f, false);
  EXPECT_EQ(stage.count(RejectReason::view_dependent), 0);
}

TEST(Reprojection, FollowsAnObjectThatMoves) {
  Scene scene = cornell();
  Index node = kNone;
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (!scene.nodes[i].meshes.empty() && scene.nodes[i].name.find("tall") != std::string::npos)
      node = static_cast<Index>(i);
  }
  ASSERT_NE(node, kNone);
  Stage stage(std::move(scene), {node});
  stage.render();
  Transform moved = stage.scene.source().nodes[static_cast<size_t>(node)].transform;
  moved.translation.x += 0.3f;
  stage.scene.set_transform(node, moved);
  stage.vote(10.0f, false);
  int shifted = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (is_vote(stage.votes[i]) && static_cast<uint32_t>(stage.votes[i]) != i) ++shifted;
  }
  EXPECT_GT(shifted, 5);
  EXPECT_GT(stage.count(RejectReason::occluded), 0);
}

TEST(Reprojection, RejectsRelitSurfaces) {
  Scene scene = cornell();
  scene.materials.push_back({});
  PunctualLight light;
  light.intensity = Rgb(5);
  scene.lights.push_back(light);
  Node node;
  node.light = 0;
  node.transform.translation = {0, 1, 0};
  scene.add_node(node);
  Stage stage(std::move(scene));
  stage.render();
  stage.vote(1.0f / 256.0f, true);
  EXPECT_EQ(stage.count(RejectReason::relit), 0);  // verified, and unchanged
  const auto limited = [&] {
    return std::count_if(stage.limits.begin(), stage.limits.end(), [](uint32_t n) { return n < 16; });
  };
  EXPECT_EQ(limited(), 0);
  light.intensity = Rgb(4.5f);
  stage.scene.set_light(0, light);
  stage.vote(1.0f / 256.0f, true);
  EXPECT_GT(limited(), 20);  // a small change: limited
  light.intensity = Rgb(0.5f);
  stage.scene.set_light(0, light);
  stage.vote(1.0f / 256.0f, true);
  EXPECT_GT(stage.count(RejectReason::relit), 20);  // a large change: ended
  EXPECT_EQ(std::count(stage.limits.begin(), stage.limits.end(), 0u), stage.count(RejectReason::relit));
}

TEST(Reprojection, ASampleOnAnotherSurfaceShortensAnInheritedHistory) {
  Stage stage(cornell());
  stage.render();
  uint32_t other = 1;
  while (!stage.hits[other].valid() || stage.hits[other].instance == stage.hits[0].instance) ++other;
  stage.render();
  stage.pixels[other].inherited = 1;
  stage.stored[other].hit = stage.hits[0];                           // the inherited sample lies elsewhere
  stage.history.mutable_view().store(other, {Rgb(7), 38, 114, 20});  // variance 2, and 6 over all channels
  stage.render();
  EXPECT_EQ(stage.history.samples[other], kMixedSamples);
  EXPECT_EQ(stage.history.mean[other], Rgb(7));
  EXPECT_FLOAT_EQ(stage.history.m2[other], 2.0f * static_cast<float>(kMixedSamples - 1));
  EXPECT_FLOAT_EQ(stage.history.m2_rgb[other], 6.0f * static_cast<float>(kMixedSamples - 1));
  EXPECT_EQ(stage.pixels[other].mixed, 1u);
}

TEST(Reprojection, OnlyTheInheritedPartOfAHistoryIsShortened) {
  Stage stage(cornell());
  stage.render();
  uint32_t other = 1;
  while (!stage.hits[other].valid() || stage.hits[other].instance == stage.hits[0].instance) ++other;
  StoredPixel& pixel = stage.pixels[other];
  pixel.inherited = 1;
  pixel.fresh = Rgb(1);
  pixel.fresh_samples = 4;
  stage.stored[other].hit = stage.hits[0];
  stage.history.mutable_view().store(other, {(Rgb(7) * 16.0f + Rgb(1) * 4.0f) / 20.0f, 38, 114, 20});
  stage.render();
  EXPECT_EQ(stage.history.samples[other], kMixedSamples + 4);
  EXPECT_NEAR(stage.history.mean[other].r, (7.0f * kMixedSamples + 1.0f * 4) / (kMixedSamples + 4), 1e-5f);
}

}  // namespace
}  // namespace relume

// Records of first vertices where camera subpaths fill cells: the light of the cell and that of splats have a direction
// each, which gives this light.
#include <algorithm>
#include <cstddef>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framebuffer/shared_buffers.h"
#include "render/session.h"
#include "scene/compiled_scene.h"
#include "techniques/gbuffer/primary_hits/primary_hits.h"
#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/temporal/reprojection/testing/forward_moves.h"
#include "techniques/transport/path/first_vertex.h"

namespace relume {
namespace {

using testing::after_a_move;
using testing::copy_of;
using testing::Outcomes;
using testing::varnished_cornell;

constexpr int kSize = 32;

using Choices = std::tuple<EstimatorChoice, CacheChoice, ReuseChoice>;

RenderSettings settings_of(const Choices& choices) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.path.max_bounces = 3;
  settings.history = HistoryChoice::reproject;
  settings.reproject.stored = StoredSampleChoice::one;
  settings.reproject.max_distance = 0.1f;  // a pixel covers 2 % of its depth
  settings.psf.edge_rays = 0;              // pixels show samples
  settings.apsf.min_samples = 16;
  std::tie(settings.estimator, settings.cache, settings.reuse) = choices;
  return settings;
}

class FirstLightOfCells : public ::testing::TestWithParam<Choices> {};
INSTANTIATE_TEST_SUITE_P(Choices, FirstLightOfCells,
                         ::testing::Values(Choices(EstimatorChoice::bdpt, CacheChoice::psf, ReuseChoice::none),
                                           Choices(EstimatorChoice::vcm, CacheChoice::apsf, ReuseChoice::none),
                                           Choices(EstimatorChoice::bdpt, CacheChoice::apsf, ReuseChoice::ris),
                                           Choices(EstimatorChoice::vcm, CacheChoice::psf, ReuseChoice::restir_di),
                                           Choices(EstimatorChoice::bdpt, CacheChoice::psf, ReuseChoice::restir_gi),
                                           Choices(EstimatorChoice::vcm, CacheChoice::apsf, ReuseChoice::restir_gi)));

/// The surface at a hit, as a pinhole camera sees it.
SurfacePoint surface_at(const SceneView& scene, const Hit& hit) {
  const Vec3 to_hit = surface_position(scene, hit).now - scene.camera.position;
  const Ray ray{scene.camera.position, glm::normalize(to_hit), kInfinity};
  SurfacePoint sp;
  make_surface_point(scene, ray, hit, scene.camera.cone_width() + scene.camera.cone_spread() * hit.t, sp);
  return sp;
}

void expect_near(const Rgb& recorded, const Rgb& light, size_t pixel) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(recorded[c], light[c], 2e-3f * (1.0f + light[c])) << pixel;
}

/// The frame's light of one pixel, from what cells hold and from what they lack.
struct PixelLight {
  Rgb for_cell{0};
  Rgb beside{0};
};

std::vector<PixelLight> light_of(const Session& session) {
  const std::vector<FilteredPixel> pixels = copy_of(session, kFilteredPixels);
  const std::vector<Rgb> radiance = copy_of(session, kRadiance);
  const std::vector<Rgb> cells = copy_of(session, kRadianceCells);
  std::vector<PixelLight> light(pixels.size());
  for (size_t i = 0; i < light.size(); ++i)
    light[i] = {pixels[i].traced / pixels[i].survival, radiance[i] - cells[i] - pixels[i].unfiltered};
  return light;
}

void expect_near(float recorded, float y, size_t pixel) { EXPECT_NEAR(recorded, y, 2e-3f * (1.0f + y)) << pixel; }

/// Compares the light of the recorded directions, that for cells first, with the light of the sample. Where reservoirs
/// share a direction with splats or with the light for cells, only luminance is the same.
void expect_recorded(const Rgb& scattered, const Rgb& direct, const PixelLight& light, ReuseChoice reuse,
                     size_t pixel) {
  if (resamples_indirect_light(reuse)) {
    return expect_near(luminance(scattered) + luminance(direct), luminance(light.for_cell + light.beside), pixel);
  }
  expect_near(scattered, light.for_cell, pixel);
  if (reuse == ReuseChoice::none) return expect_near(direct, light.beside, pixel);
  expect_near(luminance(direct), luminance(light.beside), pixel);
}

/// The BSDF for the recorded directions gives the light of the sample.
TEST_P(FirstLightOfCells, HasDirectionsOfItsLight) {
  Session session(varnished_cornell(), settings_of(GetParam()));
  const CompiledScene scene(varnished_cornell(), CompileOptions{.camera = {}, .width = kSize, .height = kSize});
  int in_cells = 0;
  int beside_cells = 0;
  for (int frame = 0; frame < 3; ++frame) {
    session.render_frame();
    const std::vector<Hit> hits = copy_of(session, kPrimaryHits);
    const std::vector<uint32_t> at_hit = copy_of(session, kCellsAtHit);
    const std::vector<FirstVertex> vertices = copy_of(session, kFirstVertices);
    const std::vector<PixelLight> light = light_of(session);
    for (size_t i = 0; i < hits.size(); ++i) {
      if (!hits[i].valid() || at_hit[i] == 0) continue;
      const SurfacePoint sp = surface_at(scene.view(), hits[i]);
      if (!is_black(sp.emission)) continue;
      const FirstVertex& v = vertices[i];
      const Rgb scattered = eval_pdf(sp, v.scatter).f * v.indirect;
      const Rgb direct = is_black(v.direct) ? Rgb(0) : eval_pdf(sp, v.to_light).f * v.direct;
      expect_recorded(scattered, direct, light[i], std::get<2>(GetParam()), i);
      in_cells += is_black(light[i].for_cell) ? 0 : 1;
      beside_cells += is_black(v.direct) ? 0 : 1;
    }
  }
  EXPECT_GT(in_cells, 300);
  EXPECT_GT(beside_cells, 100);
}

/// A history of splats that look different from the new view must not move with a cell that is looked up: with a bound
/// that no light on gloss meets, no history with splats does.
TEST_P(FirstLightOfCells, EndsHistoriesWhoseSplatsLookDifferent) {
  RenderSettings settings = settings_of(GetParam());
  const Outcomes usual = after_a_move(varnished_cornell(), settings, 0.5f);
  settings.reproject.error = 1e-9f;
  const Outcomes strict = after_a_move(varnished_cornell(), settings, 0.5f);
  EXPECT_GT(strict.count(RejectReason::view_dependent), usual.count(RejectReason::view_dependent) + kSize);
  settings.estimator = EstimatorChoice::path;
  settings.reuse = ReuseChoice::none;
  const Outcomes without = after_a_move(varnished_cornell(), settings, 0.5f);
  EXPECT_GT(strict.count(RejectReason::view_dependent), without.count(RejectReason::view_dependent) + kSize);
}

/// Records change no bit of the image.
TEST_P(FirstLightOfCells, KeepsTheBitsOfAStillView) {
  RenderSettings settings = settings_of(GetParam());
  Session reprojected(varnished_cornell(), settings);
  settings.history = HistoryChoice::accumulate;
  Session accumulated(varnished_cornell(), settings);
  for (int frame = 1; frame <= 8; ++frame) {
    reprojected.render_frame();
    accumulated.render_frame();
    EXPECT_EQ(reprojected.image().pixels, accumulated.image().pixels) << "frame " << frame;
  }
}

}  // namespace
}  // namespace relume

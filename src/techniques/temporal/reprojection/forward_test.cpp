// Forward reprojection with every estimator, radiance cache and kind of reservoirs: which histories move, and which
// light the records of first vertices contain.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "framebuffer/shared_buffers.h"
#include "render/session.h"
#include "scene/compiled_scene.h"
#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/reuse/reservoir/receiver.h"
#include "techniques/temporal/reprojection/testing/forward_moves.h"
#include "techniques/transport/path/first_vertex.h"

namespace relume {
namespace {

using testing::after_a_move;
using testing::copy_of;
using testing::matte_cornell;
using testing::metal_cornell;
using testing::Outcomes;
using testing::shift_camera;
using testing::varnished_cornell;

constexpr int kSize = 32;
constexpr int kPixels = kSize * kSize;

struct Choices {
  std::string name;
  EstimatorChoice estimator = EstimatorChoice::path;
  CacheChoice cache = CacheChoice::none;
  ReuseChoice reuse = ReuseChoice::none;

  bool has_whole_paths() const { return reuse == ReuseChoice::restir_pt; }
  /// Whether the history looks cells up again.
  bool has_cells() const { return cache != CacheChoice::none && cache != CacheChoice::sharc && !has_whole_paths(); }
  /// Whether these cells hold all light that surfaces reflect: neither reservoirs nor splats add any.
  bool has_whole_cells() const {
    const bool has_direct = reuse == ReuseChoice::none || reuse == ReuseChoice::ris;
    return has_cells() && has_direct && estimator == EstimatorChoice::path;
  }
  /// Whether no reservoirs are beside the cells, so most histories on gloss move without them.
  bool looks_up_most() const { return has_whole_cells() || (has_cells() && reuse == ReuseChoice::none); }
};

const std::vector<Choices>& all_choices() {
  static const std::vector<Choices> list{
      {.name = "path"},
      {.name = "bdpt", .estimator = EstimatorChoice::bdpt},
      {.name = "light", .estimator = EstimatorChoice::light},
      {.name = "vcm", .estimator = EstimatorChoice::vcm},
      {.name = "psf", .cache = CacheChoice::psf},
      {.name = "apsf", .cache = CacheChoice::apsf},
      {.name = "apg", .cache = CacheChoice::apg},
      {.name = "apsf_apg", .cache = CacheChoice::apsf_apg},
      {.name = "sharc", .cache = CacheChoice::sharc},
      {.name = "ris", .reuse = ReuseChoice::ris},
      {.name = "restir_di", .reuse = ReuseChoice::restir_di},
      {.name = "restir_gi", .reuse = ReuseChoice::restir_gi},
      {.name = "restir_di_gi", .reuse = ReuseChoice::restir_di_gi},
      {.name = "restir_pt", .reuse = ReuseChoice::restir_pt},
      {.name = "bdpt_restir_gi", .estimator = EstimatorChoice::bdpt, .reuse = ReuseChoice::restir_gi},
      {.name = "vcm_restir_di_gi", .estimator = EstimatorChoice::vcm, .reuse = ReuseChoice::restir_di_gi},
      {.name = "psf_ris", .cache = CacheChoice::psf, .reuse = ReuseChoice::ris},
      {.name = "sharc_restir_di", .cache = CacheChoice::sharc, .reuse = ReuseChoice::restir_di},
      {.name = "psf_restir_di", .cache = CacheChoice::psf, .reuse = ReuseChoice::restir_di},
      {.name = "apsf_apg_restir_di", .cache = CacheChoice::apsf_apg, .reuse = ReuseChoice::restir_di},
      {.name = "psf_restir_gi", .cache = CacheChoice::psf, .reuse = ReuseChoice::restir_gi},
      {.name = "apg_restir_gi", .cache = CacheChoice::apg, .reuse = ReuseChoice::restir_gi},
      {.name = "apg_restir_di_gi", .cache = CacheChoice::apg, .reuse = ReuseChoice::restir_di_gi},
      {.name = "sharc_restir_gi", .cache = CacheChoice::sharc, .reuse = ReuseChoice::restir_gi},
      {.name = "bdpt_psf", .estimator = EstimatorChoice::bdpt, .cache = CacheChoice::psf},
      {.name = "vcm_apsf", .estimator = EstimatorChoice::vcm, .cache = CacheChoice::apsf},
      {.name = "bdpt_psf_ris",
       .estimator = EstimatorChoice::bdpt,
       .cache = CacheChoice::psf,
       .reuse = ReuseChoice::ris},
      {.name = "vcm_psf_restir_di",
       .estimator = EstimatorChoice::vcm,
       .cache = CacheChoice::psf,
       .reuse = ReuseChoice::restir_di},
      {.name = "bdpt_psf_restir_gi",
       .estimator = EstimatorChoice::bdpt,
       .cache = CacheChoice::psf,
       .reuse = ReuseChoice::restir_gi},
      {.name = "vcm_apsf_restir_di_gi",
       .estimator = EstimatorChoice::vcm,
       .cache = CacheChoice::apsf,
       .reuse = ReuseChoice::restir_di_gi},
      {.name = "apg_restir_pt", .cache = CacheChoice::apg, .reuse = ReuseChoice::restir_pt},
      {.name = "sharc_restir_pt", .cache = CacheChoice::sharc, .reuse = ReuseChoice::restir_pt},
  };
  return list;
}

RenderSettings settings_of(const Choices& choices) {
  RenderSettings s;
  s.width = s.height = kSize;
  s.threads = 1;
  s.path.max_bounces = 3;
  s.history = HistoryChoice::reproject;
  s.reproject.stored = StoredSampleChoice::one;
  s.reproject.max_distance = 0.1f;  // a pixel covers 2 % of its depth
  s.estimator = choices.estimator;
  s.cache = choices.cache;
  s.reuse = choices.reuse;
  return s;
}

/// Tests of some of the choices, by index.
class ForwardOfChoice : public ::testing::TestWithParam<size_t> {
 protected:
  static const Choices& choices() { return all_choices()[GetParam()]; }
};
std::string name_of(const ::testing::TestParamInfo<size_t>& info) { return all_choices()[info.param].name; }

std::vector<size_t> indices_of(bool (*fits)(const Choices&)) {
  std::vector<size_t> indices;
  for (size_t i = 0; i < all_choices().size(); ++i) {
    if (fits(all_choices()[i])) indices.push_back(i);
  }
  return indices;
}

class Forward : public ForwardOfChoice {};
INSTANTIATE_TEST_SUITE_P(All, Forward, ::testing::Range(size_t{0}, all_choices().size()), name_of);

class ForwardOfPaths : public ForwardOfChoice {};
INSTANTIATE_TEST_SUITE_P(All, ForwardOfPaths, ::testing::ValuesIn(indices_of([](const Choices& c) {
                           return c.estimator == EstimatorChoice::path;
                         })),
                         name_of);

class ForwardOfReservoirs : public ForwardOfChoice {};
INSTANTIATE_TEST_SUITE_P(All, ForwardOfReservoirs, ::testing::ValuesIn(indices_of([](const Choices& c) {
                           return c.reuse != ReuseChoice::none && !c.has_cells();
                         })),
                         name_of);

class ForwardOfPathReservoirs : public ForwardOfChoice {};
INSTANTIATE_TEST_SUITE_P(All, ForwardOfPathReservoirs, ::testing::ValuesIn(indices_of([](const Choices& c) {
                           return (resamples_indirect_light(c.reuse) || c.has_whole_paths()) && !c.has_cells();
                         })),
                         name_of);

class ForwardWithCells : public ForwardOfChoice {};
INSTANTIATE_TEST_SUITE_P(All, ForwardWithCells,
                         ::testing::ValuesIn(indices_of([](const Choices& c) { return c.looks_up_most(); })), name_of);

TEST_P(Forward, LambertNeverDependsOnTheView) {
  RenderSettings settings = settings_of(choices());
  settings.reproject.error = 1e-6f;
  const Outcomes outcomes = after_a_move(matte_cornell(), settings, 0.5f);
  EXPECT_EQ(outcomes.count(RejectReason::view_dependent), 0);
  EXPECT_EQ(outcomes.count(RejectReason::looked_up), 0);
  EXPECT_GT(outcomes.kept(), kPixels / 5);
}

TEST_P(Forward, GlossIsJudgedAsWithPaths) {
  const auto judged = [](const Choices& judged_choices, float error) {
    RenderSettings settings = settings_of(judged_choices);
    settings.reproject.error = error;
    const Outcomes outcomes = after_a_move(metal_cornell(), settings, 0.5f);
    return std::pair(outcomes.count(RejectReason::view_dependent), outcomes.count(RejectReason::looked_up));
  };
  const auto [rejected, looked_up] = judged(choices(), 1.0f / 256.0f);
  if (choices().has_whole_cells()) {
    // Rejected only if a pixel shows several surfaces, or some of its samples have no cell.
    EXPECT_GT(looked_up, rejected);
  } else if (choices().looks_up_most()) {
    EXPECT_GT(looked_up, 20);  // the weights of light paths leave little light to splats
  } else if (choices().has_cells()) {
    // Also rejected if the light of reservoirs looks different.
    const Choices without{.name = "", .estimator = choices().estimator, .cache = choices().cache};
    EXPECT_GT(rejected, judged(without, 1.0f / 256.0f).first);
  } else {
    EXPECT_EQ(looked_up, 0);
  }
  const int different = rejected + looked_up;
  const int of_paths = judged(all_choices()[0], 1.0f / 256.0f).first;
  EXPECT_GT(of_paths, kPixels / 10);
  EXPECT_GT(different, of_paths / 3);
  EXPECT_LT(different, of_paths * 2);
  const auto [still_rejected, still_looked_up] = judged(choices(), 4);
  EXPECT_LT(still_rejected + still_looked_up, different);
}

/// Moves the tall box after eight frames. Its shadow moves with it.
Outcomes after_a_move_of_the_box(const RenderSettings& settings) {
  Scene scene = matte_cornell();
  const auto box =
      std::find_if(scene.nodes.begin(), scene.nodes.end(), [](const Node& n) { return n.name == "tall box"; });
  const auto index = static_cast<Index>(box - scene.nodes.begin());
  Transform moved = box->transform;
  moved.translation.x += 0.4f;
  Session session(std::move(scene), settings, {index});
  for (int i = 0; i < 8; ++i) session.render_frame();
  session.set_transform(session.find_node("tall box"), moved);
  session.render_frame();
  return Outcomes(session);
}

TEST_P(Forward, ShadowsThatMoveEndHistories) {
  RenderSettings settings = settings_of(choices());
  settings.reproject.light_error = 1e-3f;
  const Outcomes outcomes = after_a_move_of_the_box(settings);
  EXPECT_GT(outcomes.count(RejectReason::relit), 3);
  // Where the light is the same, the repeated light sample is, too.
  EXPECT_GT(outcomes.kept(), outcomes.count(RejectReason::relit));
}

/// Expects E of the first vertices to be the light of this frame's samples. The surfaces are Lambertian, so the
/// directions do not matter. Returns the number of pixels with direct light, or with any light if paths of reservoirs
/// contain both.
int expect_light_of_samples(const Session& session, const Choices& choices) {
  const bool has_cells = choices.has_cells();
  const bool whole_cells = choices.has_whole_cells();
  const std::vector<FirstVertex> vertices = copy_of(session, kFirstVertices);
  const std::vector<Rgb> albedo = copy_of(session, kSurfaceAlbedo);
  std::vector<Rgb> reflected = copy_of(session, kRadiance);
  std::vector<FilteredPixel> pixels(vertices.size());
  std::vector<Rgb> cells(vertices.size());
  if (has_cells) pixels = copy_of(session, kFilteredPixels);
  if (has_cells) cells = copy_of(session, kRadianceCells);
  int lit = 0;
  for (size_t i = 0; i < vertices.size(); ++i) {
    const FirstVertex& v = vertices[i];
    if (max_component(albedo[i]) > 0.99f || is_black(albedo[i])) continue;  // the lamp, or the background
    if (has_cells) {
      const Vec3 to_light = whole_cells ? v.to_light : Vec3(0);                    // of the path
      if (length_squared(v.scatter) + length_squared(to_light) == 0.0f) continue;  // a cell ended the path here
      const Rgb beside = whole_cells ? Rgb(0) : reflected[i] - cells[i];           // no surface here emits light
      reflected[i] = pixels[i].traced / pixels[i].survival + beside;
    }
    const Rgb recorded = albedo[i] * kInvPi * (v.indirect + v.direct);
    if (choices.reuse == ReuseChoice::restir_gi) {  // one direction has the luminance of two
      const float y = luminance(reflected[i]);
      EXPECT_NEAR(luminance(recorded), y, 2e-3f * (1.0f + y)) << i;
    } else {
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(recorded[c], reflected[i][c], 2e-3f * (1.0f + reflected[i][c])) << i;
    }
    lit += is_black(choices.reuse == ReuseChoice::restir_pt ? v.indirect : v.direct) ? 0 : 1;
  }
  return lit;
}

TEST_P(ForwardOfPaths, RecordTheLightOfSamples) {
  RenderSettings settings = settings_of(choices());
  settings.psf.edge_rays = 0;  // pixels show samples
  Session session(matte_cornell(), settings);
  int lit = 0;
  for (int i = 0; i < 4; ++i) {
    session.render_frame();
    lit += expect_light_of_samples(session, choices());
  }
  EXPECT_GT(lit, kPixels / 10);
}

/// The BSDF for the recorded directions, at the primary hits of the reservoirs, gives the light of the samples.
TEST_P(ForwardOfPathReservoirs, RecordDirectionsOfGloss) {
  const BufferKey<ReceiverRecord> receivers{choices().has_whole_paths() ? "restir-pt-receivers"
                                                                        : "restir-gi-receivers"};
  RenderSettings settings = settings_of(choices());
  settings.psf.edge_rays = 0;  // pixels show samples
  settings.restir_gi.reuse_glossy = true;
  Session session(varnished_cornell(), settings);
  const CompiledScene scene(varnished_cornell(), CompileOptions{.camera = {}, .width = kSize, .height = kSize});
  for (int i = 0; i < 3; ++i) session.render_frame();
  const std::vector<ReceiverRecord> records = copy_of(session, receivers);
  const std::vector<FirstVertex> vertices = copy_of(session, kFirstVertices);
  const std::vector<Rgb> radiance = copy_of(session, kRadiance);
  int lit = 0;
  for (size_t i = 0; i < records.size(); ++i) {
    if (!records[i].valid()) continue;
    Receiver r;
    make_receiver(scene.view(), records[i], r);
    if (!is_black(r.sp.emission)) continue;
    const FirstVertex& v = vertices[i];
    Rgb sum(0);
    if (length_squared(v.scatter) > 0.0f) sum += eval_pdf(r.sp, v.scatter).f * v.indirect;
    if (length_squared(v.to_light) > 0.0f) sum += eval_pdf(r.sp, v.to_light).f * v.direct;
    const float y = luminance(radiance[i]);
    EXPECT_NEAR(luminance(sum), y, 2e-3f * (1.0f + y)) << i;
    lit += y > 0.0f ? 1 : 0;
  }
  EXPECT_GT(lit, kPixels / 4);
}

/// Records change no bit of the image, also on glossy surfaces.
TEST_P(ForwardOfReservoirs, AStillViewHasTheBitsOfItsMean) {
  RenderSettings settings = settings_of(choices());
  Session reprojected(varnished_cornell(), settings);
  settings.history = HistoryChoice::accumulate;
  Session accumulated(varnished_cornell(), settings);
  for (int frame = 1; frame <= 8; ++frame) {
    reprojected.render_frame();
    accumulated.render_frame();
    EXPECT_EQ(reprojected.image().pixels, accumulated.image().pixels) << "frame " << frame;
  }
}

/// Where the light of cells is looked up, only the rest of the history moves.
TEST_P(ForwardWithCells, LookThemUpFromTheNewView) {
  Session session(metal_cornell(), settings_of(choices()));
  for (int i = 0; i < 8; ++i) session.render_frame();
  EXPECT_EQ(copy_of(session, kCellsSamples), std::vector<uint32_t>(kPixels, 8));
  shift_camera(session, 0.3f);
  session.render_frame();
  const std::vector<uint32_t> reasons = copy_of(session, kHistoryReason);
  const std::vector<uint32_t> samples = copy_of(session, kSamples);
  const std::vector<uint32_t> of_cells = copy_of(session, kCellsSamples);
  const std::vector<Rgb> cells = copy_of(session, kRadianceCells);
  const std::vector<Rgb> mean_of_cells = copy_of(session, kCellsMean);
  int looked_up = 0;
  for (size_t i = 0; i < reasons.size(); ++i) {
    const auto reason = static_cast<RejectReason>(reasons[i]);
    if (reason == RejectReason::none) {
      EXPECT_EQ(of_cells[i], samples[i]) << i;
    }
    if (reason != RejectReason::looked_up) continue;
    ++looked_up;
    EXPECT_EQ(samples[i], 9u) << i;
    EXPECT_EQ(of_cells[i], 1u) << i;
    EXPECT_EQ(mean_of_cells[i], cells[i]) << i;
  }
  EXPECT_GT(looked_up, 20);
}

struct Mean {
  double value = 0;
  double error = 0;
};

/// Mean luminance of the image after `frames` frames and, if `moves`, as many after a move of the camera. Adds seeds
/// until the standard error is below 0.7 %, which takes some 25; at most 100 bound the time.
Mean mean_of(const RenderSettings& settings, int frames, bool moves) {
  Session session(varnished_cornell(), settings);
  const CameraPose start = session.camera();
  double sum = 0;
  double squares = 0;
  Mean mean;
  for (int seed = 1; seed <= 100; ++seed) {
    session.set_camera(start);
    session.restart(seed);
    shift_camera(session, moves ? -0.1f : 0.0f);
    for (int i = 0; i < frames; ++i) session.render_frame();
    session.set_camera(start);
    for (int i = 0; moves && i < frames; ++i) session.render_frame();
    double value = 0;
    for (const Rgb& pixel : session.image().pixels) value += static_cast<double>(luminance(pixel)) / kPixels;
    sum += value;
    squares += value * value;
    mean.value = sum / seed;
    if (seed < 8) continue;
    mean.error = std::sqrt(std::max(0.0, squares / seed - mean.value * mean.value) / (seed - 1));
    if (mean.error < 0.007 * mean.value) break;
  }
  return mean;
}

/// Cells of sharc have light of more bounces than paths; SlowSharcEnergy compares their mean.
class ForwardOfSomeBounces : public ForwardOfChoice {};
INSTANTIATE_TEST_SUITE_P(All, ForwardOfSomeBounces, ::testing::ValuesIn(indices_of([](const Choices& c) {
                           return c.cache != CacheChoice::sharc;
                         })),
                         name_of);

/// On surfaces that depend on the view. The table of combinations has matte ones.
TEST_P(ForwardOfSomeBounces, HasTheMeanOfPathTracing) {
  static const Mean truth = [] {
    RenderSettings settings = settings_of({.name = "path"});
    settings.history = HistoryChoice::accumulate;
    return mean_of(settings, 64, false);
  }();
  const Mean mean = mean_of(settings_of(choices()), 8, true);
  ASSERT_LT(mean.error, 0.01 * mean.value);
  double bias = 0.02;  // and that of the choice, from docs/combinations.md
  if (choices().cache != CacheChoice::none) bias += 0.03;
  if (choices().estimator == EstimatorChoice::vcm) bias += 0.01;
  EXPECT_NEAR(mean.value, truth.value, bias * truth.value + 4.5 * std::hypot(mean.error, truth.error));
}

}  // namespace
}  // namespace relume

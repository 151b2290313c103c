#include "render/presets.h"

#include <cmath>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "render/settings.h"

namespace relume {
namespace {

class Presets : public ::testing::TestWithParam<Preset> {};

TEST_P(Presets, RenderFramesWhileTheCameraMoves) {
  AllSettings settings = resolve({.preset = std::string(GetParam().name)});
  settings.render.width = 24;
  settings.render.height = 16;
  settings.render.threads = 1;
  Session session(find_builtin_scene("cornell")->build(), settings.render);
  CameraPose camera = session.camera();
  for (int frame = 0; frame < 4; ++frame) {
    camera.to_world[3].x += 0.02f;
    session.set_camera(camera);
    session.render_frame();
  }
  double sum = 0;
  for (const Rgb& pixel : session.image().pixels) sum += static_cast<double>(pixel.x + pixel.y + pixel.z);
  EXPECT_TRUE(std::isfinite(sum));
  EXPECT_GT(sum, 0);
}

/// The choice in each slot.
std::string slots_of(const RenderSettings& settings) {
  RenderSettings copy = settings;
  const SettingList list = describe(copy);
  std::string text;
  for (const char* slot : {"estimator", "lights", "guide", "reuse", "cache", "allocation", "history", "denoise"})
    text += to_string(require_setting(list, slot, "")) + " ";
  return text;
}

/// Whether a preset adds a technique to existing settings.
bool adds_only(const Preset& preset) { return preset.json.find("estimator") == std::string_view::npos; }

TEST_P(Presets, AreIndependentOfSceneSettings) {
  const Preset& preset = GetParam();
  if (adds_only(preset)) return;
  const std::string alone = slots_of(resolve({.preset = std::string(preset.name)}).render);
  for (const Preset& other : presets()) {
    const SettingSources sources{
        .scene_json = std::string(other.json), .scene_place = "view.json", .preset = std::string(preset.name)};
    EXPECT_EQ(slots_of(resolve(sources).render), alone) << "over the settings of " << other.name;
  }
}

TEST(PaperPresets, HaveNoRouletteWhereThePaperHasNone) {
  EXPECT_FALSE(resolve({.preset = "paper-002"}).render.path.russian_roulette);
  EXPECT_TRUE(resolve({.preset = "paper-000"}).render.path.russian_roulette);
}

/// §4.3 weighs changes of energy and position. §4.1 counts the samples of a region, also those that reached no light.
TEST(PaperPresets, ExploreAndCountAsDittebrandt) {
  const RenderSettings paper = resolve({.preset = "paper-002"}).render;
  EXPECT_EQ(paper.vlc.change_measure, ChangeMeasure::amount);
  EXPECT_EQ(paper.octree.count, OctreeCount::all);
}

TEST(PaperPresets, AccumulateAsKoskelaBeforeRegression) {
  const BmfrSettings bmfr = resolve({.preset = "paper-004"}).render.bmfr;
  EXPECT_FLOAT_EQ(bmfr.alpha, 0.2f);
  EXPECT_EQ(bmfr.detail, 0) << "the restored details are an addition to the paper";
}

TEST(ReusePresets, HaveTheParametersOfTheirPrograms) {
  const RenderSettings research = resolve({.preset = "restir-research"}).render;
  EXPECT_EQ(research.ris.candidates, 32);
  EXPECT_EQ(research.restir.neighbours, 5);
  EXPECT_EQ(research.restir.correction, ReuseCorrection::exact);
  const RenderSettings rtxdi = resolve({.preset = "restir-rtxdi"}).render;
  EXPECT_EQ(rtxdi.ris.candidates, 8);
  EXPECT_EQ(rtxdi.restir.neighbours, 1);
  EXPECT_EQ(rtxdi.restir.correction, ReuseCorrection::basic);
  const RestirGiSettings indirect = resolve({.preset = "restir-gi-rtxdi"}).render.restir_gi;
  EXPECT_EQ(indirect.cap, 8);
  EXPECT_EQ(indirect.neighbours, 2);
  EXPECT_EQ(indirect.correction, ReuseCorrection::basic);
  EXPECT_TRUE(indirect.reuse_glossy);
}

TEST(ReusePresets, ShiftPathsByTheRulesOfTheirPapers) {
  const RenderSettings first = resolve({.preset = "restir-pt-2022"}).render;
  EXPECT_EQ(first.reuse, ReuseChoice::restir_pt);
  EXPECT_EQ(first.restir_pt.shift, PathShiftKind::hybrid);
  EXPECT_EQ(first.restir_pt.connect, ConnectRuleKind::distance_2022);
  EXPECT_EQ(first.path.max_bounces, 9);
  EXPECT_FALSE(first.path.russian_roulette);
  EXPECT_FALSE(first.restir_pt.reciprocal);
  const RenderSettings enhanced = resolve({.preset = "restir-pt-2026"}).render;
  EXPECT_EQ(enhanced.restir_pt.connect, ConnectRuleKind::footprint);
  EXPECT_EQ(enhanced.restir_pt.radius, 16);
  EXPECT_EQ(enhanced.restir_pt.correction, PathCorrection::exact);
  EXPECT_TRUE(enhanced.restir_pt.reciprocal);
  EXPECT_EQ(enhanced.restir_pt.duplication, 0) << "would bias the image";
}

TEST(AsvgfPresets, HaveTheParametersOfTheirPrograms) {
  const RenderSettings paper = resolve({.preset = "asvgf-2018"}).render;
  EXPECT_EQ(paper.denoise, DenoiseChoice::asvgf);
  EXPECT_FLOAT_EQ(paper.asvgf.alpha, 0.1f);
  EXPECT_EQ(paper.asvgf.light_tolerance, 4);
  EXPECT_TRUE(paper.asvgf.view_changes);
  EXPECT_FALSE(paper.features.split);
  const RenderSettings q2rtx = resolve({.preset = "asvgf-q2rtx"}).render;
  EXPECT_EQ(q2rtx.denoise, DenoiseChoice::asvgf);
  EXPECT_FLOAT_EQ(q2rtx.asvgf.alpha, 0.02f);
  EXPECT_EQ(q2rtx.asvgf.levels, 4);
  EXPECT_TRUE(q2rtx.features.split);
  for (const RenderSettings& preset : {paper, q2rtx}) {
    EXPECT_EQ(preset.asvgf.newest, 1) << "smoothing of edges is an addition of relume";
    EXPECT_EQ(preset.features.edge_rays, 0);
    EXPECT_EQ(preset.asvgf.antilag, 1);
  }
}

TEST(CachePresets, HaveTheParametersOfTheirPrograms) {
  const RenderSettings sharc = resolve({.preset = "sharc-1.6"}).render;
  EXPECT_EQ(sharc.cache, CacheChoice::sharc);
  EXPECT_EQ(sharc.sharc.propagation_depth, 4);
  EXPECT_EQ(sharc.sharc.min_samples, 1);
  EXPECT_FALSE(sharc.sharc.jitter);
}

TEST(GuidingPresets, HaveTheParametersOfTheirPrograms) {
  const RenderSettings quake = resolve({.preset = "mcpg-quake"}).render;
  EXPECT_EQ(quake.guide, GuideChoice::mcpg);
  EXPECT_FALSE(quake.mcpg.nee);
  EXPECT_FLOAT_EQ(quake.mcpg.bsdf_fraction, 0.1f);
  EXPECT_FLOAT_EQ(quake.mcpg.prior, 0.3f);
  EXPECT_EQ(quake.mcpg.most_count, 1024);
  EXPECT_EQ(quake.mcpg.grid.cells, 5);
  EXPECT_EQ(quake.mcpg.grid.static_slots, 800009);
}

TEST(ReferencePreset, HasNoFireflyClampWhateverTheSceneSets) {
  const std::string scene = R"({"firefly.limit": 8})";
  EXPECT_EQ(resolve({.scene_json = scene, .scene_place = "view.json"}).render.firefly.limit, 8);
  const SettingSources sources{.scene_json = scene, .scene_place = "view.json", .preset = "reference"};
  EXPECT_EQ(resolve(sources).render.firefly.limit, 0);
}

std::string preset_name(const ::testing::TestParamInfo<Preset>& info) {
  std::string name(info.param.name);
  for (char& c : name) c = c == '-' || c == '.' ? '_' : c;
  return name;
}
INSTANTIATE_TEST_SUITE_P(All, Presets, ::testing::ValuesIn(presets()), preset_name);

}  // namespace
}  // namespace relume

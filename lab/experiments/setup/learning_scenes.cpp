#include "experiments/setup/learning_scenes.h"

#include <cmath>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/shapes.h"
#include "core/hash.h"
#include "experiments/setup/references.h"

namespace relume {
namespace {

constexpr int kBounces = 2;  // five rays per path

/// Adds a lamp that emits downwards.
void add_lamp(Mesh& mesh, const Vec3& middle, float edge) {
  append(mesh, quad(middle - Vec3(0.5f * edge, 0, 0.5f * edge), {edge, 0, 0}, {0, 0, edge}));
}

float random(uint32_t lamp, uint32_t what) { return to_unit_float(hash(lamp, what, 41u)); }

}  // namespace

ExperimentScene learning_scene(std::string_view name) { return at_rest(built_in(name, kBounces)); }

ExperimentScene lamp_field() {
  SceneBuilder builder("lamp field");
  constexpr int kSide = 16;
  constexpr float kPitch = 2.5f;
  constexpr float kHalf = 0.5f * kSide * kPitch;
  builder.add("ground", quad({-2 * kHalf, 0, 2 * kHalf}, {4 * kHalf, 0, 0}, {0, 0, -4 * kHalf}),
              builder.add_material(matte("ground", Rgb(0.5f))));
  Mesh lamps[4];
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    const Vec3 middle((static_cast<float>(i % kSide) + 0.2f + 0.6f * random(i, 0)) * kPitch - kHalf,
                      0.6f + 2 * random(i, 1),
                      (static_cast<float>(i / kSide) + 0.2f + 0.6f * random(i, 2)) * kPitch - kHalf);
    add_lamp(lamps[i % 4], middle, 0.1f + 0.2f * random(i, 3));
  }
  for (int k = 0; k < 4; ++k) {
    const std::string name = "lamps " + std::to_string(k);
    builder.add(name, std::move(lamps[k]),
                builder.add_material(emitter(name, Rgb(20, 17, 12) * std::exp2(1.5f * static_cast<float>(k)))));
  }
  builder.add_camera({0, 5, kHalf + 2}, {0, 0, 2}, 50);
  ExperimentScene result;
  result.name = "lamp field";
  result.scene = builder.take();
  result.settings.path.max_bounces = kBounces;
  return at_rest(std::move(result));
}

std::optional<ExperimentScene> sponza_with_lamps(const ExperimentContext& context) {
  std::optional<ExperimentScene> result = sponza(context);
  if (!result) return result;
  result->name = "Sponza, 200 lamps";
  result->settings.path.max_bounces = kBounces;
  result->scene.environment = {};
  result->scene.environment.kind = EnvironmentKind::constant;
  result->scene.environment.color = Rgb(0.004f, 0.006f, 0.01f);
  // Four rows of fifty: behind the columns on both sides and both floors.
  Mesh lamps[2];
  for (uint32_t i = 0; i < 200; ++i) {
    const bool upper = i % 4 >= 2;
    const float side = i % 2 == 0 ? 1.0f : -1.0f;
    const float x = lerp(-11.5f, 10.0f, (static_cast<float>(i / 4) + 0.3f * random(i, 0)) / 50);
    add_lamp(lamps[i % 2], {x, upper ? 7.4f : 3.3f, -0.35f + side * (3.9f + 0.9f * random(i, 1))}, 0.12f);
  }
  for (int k = 0; k < 2; ++k) {
    Scene& scene = result->scene;
    scene.materials.push_back(emitter("lamps", k == 0 ? Rgb(120, 85, 45) : Rgb(105, 90, 70)));
    lamps[k].material = static_cast<Index>(scene.materials.size()) - 1;
    scene.meshes.push_back(std::move(lamps[k]));
    Node node;
    node.name = "lamps";
    node.meshes = {static_cast<Index>(scene.meshes.size()) - 1};
    scene.add_node(std::move(node));
  }
  return result;
}

ExperimentScene plainly_sampled(ExperimentScene scene) {
  const RenderSettings defaults;
  scene.settings.lights = LightSelectionChoice::light_tree;
  scene.settings.light_selection = defaults.light_selection;
  return scene;
}

void use_lasting_quadtrees(RenderSettings& settings) {
  settings.cdq.memory = 8;
  settings.cdq.spread = 1;
  settings.cdq.migrations = 4;
}

void use_paper_cache(RenderSettings& settings) {
  settings.vlc.exploration_cells = 1;
  settings.vlc.change_measure = ChangeMeasure::amount;
  settings.vlc.even_buckets = 1;
  settings.vlc.memory = 0;
}

int learning_reference_spp(const ExperimentContext& context, int scale) {
  return context.choose(scale >= 5 ? 64 : scale > 1 ? 192 : 512, 16);
}

std::vector<std::pair<std::string, std::string>> learning_setup(const ExperimentContext& context) {
  return {{"Size", size_text(context)},
          {"Path", "two indirect rays, as in the paper"},
          {"Reference",
           std::to_string(learning_reference_spp(context)) +
               " samples per pixel with the light tree; its own noise is known and subtracted from every MSE"}};
}

}  // namespace relume

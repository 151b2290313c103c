#include "techniques/light_sampling/visibility_light_cache/exploration.h"

#include <vector>

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(Exploration, BlendsItsGuesses) {
  std::vector<Light> lights(4);
  for (uint32_t i = 0; i < 4; ++i) {
    lights[i].kind = LightKind::point;
    lights[i].point = {Vec3(10.0f * static_cast<float>(i + 1), 0, 0), Rgb(i == 3 ? 0.0f : 1.0f)};
  }
  LightsView view;
  view.lights = view_of(lights);
  view.first_infinite = 4;
  view.bounds = {Vec3(0), 50};
  const auto table = [&](float energy, float change, float distance) {
    return build_exploration(view, Vec3(0), {energy, change, distance});
  };
  EXPECT_NEAR(table(1, 0, 0)[0].pmf, 1.0f / 3, 1e-6f);
  EXPECT_EQ(table(1, 1, 1)[3].pmf, 0.0f);                                     // dark
  EXPECT_NEAR(table(1e-3f, 0, 1)[0].pmf, 1 / (1 + 0.25f + 1.0f / 9), 1e-3f);  // inverse squares
  EXPECT_NEAR(table(1, 1, 0)[1].pmf, 1.0f / 3, 1e-6f);  // no light changed: the share goes to energy
  lights[1].changed = true;
  EXPECT_NEAR(table(1, 1, 0)[1].pmf, 0.5f + 0.5f / 3, 1e-6f);
}

TEST(Exploration, FavoursLightsNearEachCell) {
  std::vector<Light> lights(6);
  for (uint32_t i = 0; i < 6; ++i) {
    lights[i].kind = LightKind::point;
    lights[i].point = {Vec3(10.0f * static_cast<float>(i), 3, 0), Rgb(i == 5 ? 0.0f : 1.0f)};
  }
  LightsView view;
  view.lights = view_of(lights);
  view.first_infinite = 6;
  view.bounds = {Vec3(0), 50};
  Backend backend(2);
  ExplorationTables tables(host_memory());
  const auto build = [&](uint32_t cells) {
    const std::vector<LightSummary> summaries = light_summaries(view);
    tables.update_digest(backend, view_of(summaries));
    tables.build(backend, view_of(summaries), view.bounds.radius, Vec3(0), {}, cells);
  };
  build(5);
  EXPECT_EQ(tables.grid().cells, UVec3(5, 1, 1));
  for (const float x : {-7.0f, 3.0f, 22.0f, 41.0f, 99.0f}) {  // outside the grid too
    const AliasTable here = tables.grid().at(Vec3(x, 0, 0));
    float sum = 0;
    for (uint32_t i = 0; i < 6; ++i) sum += here.pmf(i);
    EXPECT_NEAR(sum, 1, 1e-5f);
    EXPECT_EQ(here.pmf(5), 0.0f);  // dark
    for (uint32_t i = 0; i < 5; ++i) EXPECT_GT(here.pmf(i), 0.05f);
  }
  EXPECT_GT(tables.grid().at(Vec3(1, 0, 0)).pmf(0), 3 * tables.grid().at(Vec3(1, 0, 0)).pmf(4));
  EXPECT_GT(tables.grid().at(Vec3(39, 0, 0)).pmf(4), 3 * tables.grid().at(Vec3(39, 0, 0)).pmf(0));
  // Changed lights rebuild the tables.
  lights[0].point.intensity = Rgb(0);
  build(5);
  EXPECT_EQ(tables.grid().at(Vec3(1, 0, 0)).pmf(0), 0.0f);
  for (Light& light : lights) light.point.intensity = Rgb(0);
  build(5);
  EXPECT_TRUE(tables.grid().empty());
  // A single cell uses the paper's table.
  for (Light& light : lights) light.point.intensity = Rgb(1);
  build(1);
  EXPECT_EQ(tables.grid().at(Vec3(39, 0, 0)).pmf(2), build_exploration(view, Vec3(0), {})[2].pmf);
}

TEST(Exploration, WeighsTheAmountOfChange) {
  std::vector<Light> before(4);
  for (uint32_t i = 0; i < 4; ++i) {
    before[i].kind = LightKind::point;
    before[i].point = {Vec3(10.0f * static_cast<float>(i), 0, 0), Rgb(1)};
  }
  std::vector<Light> now = before;
  for (Light& light : now) light.changed = true;
  now[3].changed = false;
  now[0].point.intensity = Rgb(3);  // gains twice its power
  now[1].point.position.y = 0.5f;   // moves by 1 % of the radius
  LightsView view;
  view.lights = view_of(now);
  view.previous = view_of(before);
  view.first_infinite = 4;
  view.bounds = {Vec3(0), 50};
  const std::vector<LightSummary> flags = light_summaries(view);
  EXPECT_EQ(flags[0].change, 1.0f);
  EXPECT_EQ(flags[2].change, 1.0f);
  EXPECT_EQ(flags[3].change, 0.0f);
  const std::vector<LightSummary> amounts = light_summaries(view, ChangeMeasure::amount);
  const float watts = amounts[3].watts;
  EXPECT_NEAR(amounts[0].change / watts, 2.0f + 3 * 0.01f, 1e-4f);
  EXPECT_NEAR(amounts[1].change / watts, 0.5f, 1e-4f);
  EXPECT_NEAR(amounts[2].change / watts, 0.01f, 1e-5f);
  EXPECT_EQ(amounts[3].change, 0.0f);
  view.previous = {};  // unknown
  EXPECT_FLOAT_EQ(light_summaries(view, ChangeMeasure::amount)[2].change, watts);
}

}  // namespace
}  // namespace relume

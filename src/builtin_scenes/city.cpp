// Nineteen million triangles, nearly all of them instances: 34 × 34 lots with one of twelve buildings or a park. Every
// window is modelled; fewer than 300,000 triangles are in memory.
#include <string>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/noise.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"
#include "core/hash.h"

namespace relume {
namespace {

constexpr int kLots = 34;        // along x and along z
constexpr float kLot = 30;       // metres, street included
constexpr float kPavement = 20;  // width of the raised block in a lot
constexpr float kExtent = kLots * kLot;
constexpr float kFloor = 3.4f;  // metres from floor to floor
constexpr int kDesigns = 12;

struct Design {
  int floors;
  int windows;  // along one side
  float width;  // metres
  Rgb albedo;
};

constexpr Design kBuildings[kDesigns] = {
    {6, 6, 17, {0.55f, 0.3f, 0.22f}},  {8, 7, 17, {0.66f, 0.6f, 0.5f}},    {9, 6, 15, {0.5f, 0.36f, 0.28f}},
    {10, 7, 18, {0.7f, 0.68f, 0.64f}}, {12, 8, 18, {0.6f, 0.55f, 0.47f}},  {13, 6, 14, {0.45f, 0.3f, 0.25f}},
    {15, 8, 17, {0.62f, 0.62f, 0.6f}}, {17, 7, 15, {0.68f, 0.58f, 0.45f}}, {20, 8, 17, {0.5f, 0.5f, 0.52f}},
    {24, 8, 16, {0.72f, 0.7f, 0.66f}}, {31, 9, 18, {0.42f, 0.45f, 0.5f}},  {42, 9, 18, {0.58f, 0.57f, 0.55f}},
};

struct Facade {
  Mesh wall;
  Mesh glass;
};

/// One window of a facade that faces +Z: the wall around it, the reveal 0.25 m deep, a sill and the pane. (x, y) is the
/// lower left corner of the cell.
void add_window(Facade& facade, float x, float y, float width, float z) {
  const float left = x + 0.22f * width;
  const float right = x + 0.78f * width;
  const float low = y + 0.9f;
  const float high = y + 2.8f;
  const float back = z - 0.25f;
  const auto front = [&](float x0, float y0, float x1, float y1) {
    append(facade.wall, quad({x0, y0, z}, {x1 - x0, 0, 0}, {0, y1 - y0, 0}));
  };
  front(x, y, x + width, low);
  front(x, high, x + width, y + kFloor);
  front(x, low, left, high);
  front(right, low, x + width, high);
  append(facade.wall, quad({left, low, z}, {right - left, 0, 0}, {0, 0, back - z}));
  append(facade.wall, quad({left, high, back}, {right - left, 0, 0}, {0, 0, z - back}));
  append(facade.wall, quad({left, low, z}, {0, 0, back - z}, {0, high - low, 0}));
  append(facade.wall, quad({right, low, back}, {0, 0, z - back}, {0, high - low, 0}));
  append(facade.wall, box({left - 0.08f, low - 0.1f, z - 0.02f}, {right + 0.08f, low - 0.005f, z + 0.12f}));
  const float bar = 0.5f * (left + right);
  append(facade.wall, box({bar - 0.03f, low, back - 0.01f}, {bar + 0.03f, high, back + 0.05f}));
  append(facade.glass, quad({left, low, back}, {right - left, 0, 0}, {0, high - low, 0}));
}

Facade building(const Design& design) {
  const float half = design.width / 2;
  Facade side;
  for (int floor = 0; floor < design.floors; ++floor) {
    for (int i = 0; i < design.windows; ++i) {
      const float width = design.width / static_cast<float>(design.windows);
      add_window(side, -half + width * static_cast<float>(i), kFloor * static_cast<float>(floor), width, half);
    }
  }
  Facade all;
  for (int i = 0; i < 4; ++i) {
    const Mat4 turn = rotation_y(90.0f * static_cast<float>(i));
    append(all.wall, transformed(side.wall, turn));
    append(all.glass, transformed(side.glass, turn));
  }
  const float top = kFloor * static_cast<float>(design.floors);
  append(all.wall, quad({-half, top, half}, {design.width, 0, 0}, {0, 0, -design.width}));
  append(all.wall, box({-half - 0.15f, top - 0.3f, half - 0.2f}, {half + 0.15f, top + 0.9f, half + 0.15f}));
  append(all.wall, box({-half - 0.15f, top - 0.3f, -half - 0.15f}, {half + 0.15f, top + 0.9f, -half + 0.2f}));
  append(all.wall, box({-half - 0.15f, top - 0.3f, -half + 0.2f}, {-half + 0.2f, top + 0.9f, half - 0.2f}));
  append(all.wall, box({half - 0.2f, top - 0.3f, -half + 0.2f}, {half + 0.15f, top + 0.9f, half - 0.2f}));
  append(all.wall, box({-half * 0.4f, top - 0.1f, -half * 0.3f}, {half * 0.2f, top + 3.0f, half * 0.3f}));
  return all;
}

Mesh crown(uint32_t seed) {
  Mesh mesh = icosphere(1, 3);
  for (Vec3& p : mesh.positions) p *= 1 + 0.3f * fractal_noise(p * 2.5f, 3, seed);
  mesh = transformed(std::move(mesh), translation({0, 3.6f, 0}) * scaling({1.9f, 2.1f, 1.9f}));
  smooth_normals(mesh);
  return mesh;
}

Vec3 lot_middle(int i, int j) {
  return {(static_cast<float>(i) + 0.5f - 0.5f * kLots) * kLot, 0,
          (static_cast<float>(j) + 0.5f - 0.5f * kLots) * kLot};
}

/// Design number of a lot, or -1 for a park. Tall designs are near the centre.
int design_of_lot(int i, int j) {
  const auto random = [&](uint32_t what) {
    return to_unit_float(hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), what));
  };
  if (random(1) < 0.06f) return -1;
  const float away = glm::length(lot_middle(i, j)) / (0.5f * kExtent);
  const float height = saturate(0.95f - 0.75f * away + 0.5f * (random(2) - 0.5f));
  return static_cast<int>(height * (kDesigns - 0.01f));
}

struct Lots {
  std::vector<Mat4> buildings[kDesigns];
  std::vector<Mat4> pavements;
  std::vector<Mat4> trees;
};

Lots plan_lots() {
  Lots lots;
  for (int j = 0; j < kLots; ++j) {
    for (int i = 0; i < kLots; ++i) {
      const auto random = [&](uint32_t what) {
        return to_unit_float(hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), what));
      };
      const Mat4 place = translation(lot_middle(i, j));
      lots.pavements.push_back(place);
      const int design = design_of_lot(i, j);
      if (design >= 0) {
        lots.buildings[design].push_back(place * translation({0, 0.15f, 0}) *
                                         rotation_y(90 * std::floor(4 * random(3))));
        continue;
      }
      for (uint32_t k = 0; k < 16; ++k) {
        const Vec3 offset(-7.5f + 5.0f * static_cast<float>(k % 4) + 2 * random(10 + k), 0.15f,
                          -7.5f + 5.0f * static_cast<float>(k / 4) + 2 * random(30 + k));
        lots.trees.push_back(place * translation(offset) * rotation_y(360 * random(50 + k)) *
                             scaling(Vec3(0.8f + 0.7f * random(70 + k))));
      }
    }
  }
  return lots;
}

void add_buildings(SceneBuilder& builder, Lots& lots) {
  const Index glass = builder.add_material(glossy("windows", {0.03f, 0.04f, 0.05f}, 0.08f));
  for (int k = 0; k < kDesigns; ++k) {
    const std::string name = "building " + std::to_string(k);
    Facade facade = building(kBuildings[k]);
    const Index wall = builder.add_material(matte(name, kBuildings[k].albedo));
    builder.add_instances(name, builder.add_mesh(name, std::move(facade.wall), wall), lots.buildings[k]);
    builder.add_instances(name + " windows", builder.add_mesh(name + " windows", std::move(facade.glass), glass),
                          lots.buildings[k]);
  }
}

}  // namespace

Scene build_city() {
  SceneBuilder builder("city");
  Lots lots = plan_lots();
  const Index asphalt = builder.add_material(matte("asphalt", Rgb(0.13f)));
  const Index stone = builder.add_material(matte("pavement", {0.4f, 0.39f, 0.37f}));
  const Index leaves = builder.add_material(matte("leaves", {0.12f, 0.25f, 0.06f}));
  const Index bark = builder.add_material(matte("bark", {0.22f, 0.15f, 0.1f}));
  const float ground = kExtent / 2 + 400;
  builder.add("ground", quad({-ground, 0, ground}, {2 * ground, 0, 0}, {0, 0, -2 * ground}), asphalt);
  const float half = kPavement / 2;
  builder.add_instances("pavements",
                        builder.add_mesh("pavement", box({-half, -0.01f, -half}, {half, 0.15f, half}), stone),
                        std::move(lots.pavements));
  add_buildings(builder, lots);
  builder.add_instances(
      "trunks",
      builder.add_mesh("trunk", transformed(cylinder(0.2f, 2.6f, 12, false), translation({0, -0.05f, 0})), bark),
      lots.trees);
  builder.add_instances("crowns", builder.add_mesh("crown", crown(3), leaves), std::move(lots.trees));

  Environment environment;
  environment.kind = EnvironmentKind::sun_sky;
  environment.sun_sky.sun_elevation_rad = glm::radians(38.0f);
  environment.sun_sky.sun_azimuth_rad = glm::radians(55.0f);
  environment.sun_sky.sky_scale = 0.06f;  // gives sunlit white walls a radiance near 1
  environment.sun_sky.sun_scale = 0.06f;
  builder.set_environment(environment);

  // Over the street x = 0, between two rows of lots.
  const Index camera = builder.add_camera({-60, 95, 330}, {15, 35, 0}, 50);
  builder.add_camera_path(camera, {{0, {-60, 95, 330}, {15, 35, 0}},
                                   {5, {-20, 60, 200}, {0, 30, 0}},
                                   {9, {0, 25, 80}, {0, 22, -80}},
                                   {13, {0, 22, -80}, {60, 30, -240}}});
  return builder.take();
}

}  // namespace relume

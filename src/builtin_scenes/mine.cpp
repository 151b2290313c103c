// A mine gallery with one mouth. The low sun reaches a few metres of floor behind the mouth. All light further inside
// comes from that bright spot and a little sky, around a bend.
#include <cmath>
#include <string>
#include <utility>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/noise.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"

namespace relume {
namespace {

constexpr float kInnerEnd = -14;
constexpr float kMouth = 12;
constexpr float kHalfWidth = 2.1f;

float smooth_step(float low, float high, float x) {
  const float t = saturate((x - low) / (high - low));
  return t * t * (3 - 2 * t);
}

/// Centre of the gallery's floor at x.
Vec3 gallery(float x) {
  const float t = (x - kInnerEnd) / (kMouth - kInnerEnd);
  return {x, 0, 5.0f * (1 - smooth_step(0.15f, 0.75f, t))};
}

/// Transform from +X at the origin to the gallery's floor at x, along the gallery.
Mat4 on_track(float x) {
  const Vec3 along = gallery(x + 0.05f) - gallery(x - 0.05f);
  return translation(gallery(x)) * rotation_y(glm::degrees(std::atan2(-along.z, along.x)));
}

/// The rock seen from inside: an arch with a flattened floor, closed at the inner end.
Mesh rock() {
  Mesh mesh = parametric_surface(256, 640, [](float u, float v) {
    const float x = lerp(kInnerEnd, kMouth, v);
    // The rings of the last two metres shrink to a point.
    const float closing = saturate((x - kInnerEnd) / 2);
    const float size = std::sqrt(1 - sqr(1 - closing));
    const float angle = 2 * kPi * u;
    const Vec3 q(x * 0.7f, 1.4f * std::cos(angle), 1.4f * std::sin(angle));
    // Ridges where the noise changes sign, like broken rock.
    const float ridges = std::fabs(fractal_noise(q * 1.6f, 5, 29));
    const float roughness = 1 + 0.13f * fractal_noise(q, 3, 17) + 0.15f * ridges;
    Vec3 p(0, 1.35f + 1.75f * std::sin(angle) * roughness * size, kHalfWidth * std::cos(angle) * roughness * size);
    const float floor = 0.05f * fractal_noise({x * 1.5f, 0, p.z * 1.5f}, 4, 5) - 0.08f;
    // A soft maximum keeps the crease between floor and wall from folding over.
    p.y = 0.5f * (p.y + floor + std::sqrt(sqr(p.y - floor) + 0.02f * size));
    return transform_point(on_track(x), Vec3(0, p.y, p.z));
  });
  remove_degenerate(mesh);
  return mesh;
}

Mesh stone(uint32_t seed) {
  Mesh mesh = icosphere(1, 4);
  for (Vec3& p : mesh.positions) p *= 1 + 0.25f * fractal_noise(p * 1.7f, 4, seed);
  mesh = transformed(std::move(mesh), scaling({1, 0.7f, 1}));
  smooth_normals(mesh);
  return mesh;
}

void add_stones(SceneBuilder& builder) {
  const Index material = builder.add_material(matte("stones", {0.4f, 0.34f, 0.28f}));
  std::vector<Mat4> places[2];
  for (uint32_t i = 0; i < 90; ++i) {
    const auto random = [i](uint32_t what) { return to_unit_float(hash(i, what, 23u)); };
    const float x = lerp(kInnerEnd + 2.5f, kMouth - 0.5f, random(0));
    const float side = random(1) < 0.5f ? -1.0f : 1.0f;
    const float size = 0.05f + 0.28f * sqr(random(2));
    places[i % 2].push_back(on_track(x) * translation({0, 0.02f, side * (1.05f + 0.7f * random(3))}) *
                            rotation_y(360 * random(4)) * scaling(Vec3(size)));
  }
  builder.add_instances("stones a", builder.add_mesh("stone a", stone(31), material), std::move(places[0]));
  builder.add_instances("stones b", builder.add_mesh("stone b", stone(47), material), std::move(places[1]));
}

void add_timber(SceneBuilder& builder) {
  const Index wood = builder.add_material(matte("timber", {0.42f, 0.28f, 0.16f}));
  Mesh frame = box({-0.1f, -0.2f, -1.45f}, {0.1f, 2.35f, -1.25f});
  append(frame, box({-0.1f, -0.2f, 1.25f}, {0.1f, 2.35f, 1.45f}));
  append(frame, box({-0.12f, 2.34f, -1.7f}, {0.12f, 2.58f, 1.7f}));
  std::vector<Mat4> frames;
  for (float x = kInnerEnd + 4; x < kMouth; x += 3.2f) frames.push_back(on_track(x));
  builder.add_instances("frames", builder.add_mesh("frame", std::move(frame), wood), std::move(frames));

  std::vector<Mat4> sleepers;
  for (float x = kInnerEnd + 3; x < kMouth; x += 0.6f) sleepers.push_back(on_track(x));
  builder.add_instances("sleepers",
                        builder.add_mesh("sleeper", box({-0.1f, -0.1f, -0.55f}, {0.1f, 0.03f, 0.55f}), wood),
                        std::move(sleepers));
}

void add_track(SceneBuilder& builder) {
  const Index iron = builder.add_material(metal("iron", {0.42f, 0.38f, 0.35f}, 0.5f));
  Mesh rails;
  for (const float z : {-0.36f, 0.36f}) {
    append(rails, parametric_surface(12, 140, [z](float u, float v) {
             const float angle = 2 * kPi * u;
             return transform_point(on_track(lerp(kInnerEnd + 3, kMouth, v)),
                                    Vec3(0, 0.06f + 0.04f * std::sin(angle), z - 0.025f * std::cos(angle)));
           }));
  }
  builder.add("rails", std::move(rails), iron);

  // The cart: a trough of five boards on four wheels.
  Mesh cart = box({-0.7f, 0.35f, -0.45f}, {0.7f, 0.4f, 0.45f});
  append(cart, box({-0.75f, 0.35f, -0.5f}, {0.75f, 0.95f, -0.45f}));
  append(cart, box({-0.75f, 0.35f, 0.45f}, {0.75f, 0.95f, 0.5f}));
  append(cart, box({-0.75f, 0.35f, -0.45f}, {-0.7f, 0.95f, 0.45f}));
  append(cart, box({0.7f, 0.35f, -0.45f}, {0.75f, 0.95f, 0.45f}));
  for (const float x : {-0.45f, 0.45f}) {
    for (const float z : {-0.39f, 0.33f}) {
      append(cart,
             transformed(cylinder(0.16f, 0.06f, 32, true), translation({x, 0.26f, z}) * rotation(90, Vec3(1, 0, 0))));
    }
  }
  const Mat4 place = on_track(4.2f);
  Transform transform;
  transform.translation = Vec3(place[3]);
  transform.rotation = glm::quat_cast(Mat3(place));
  builder.add("cart", std::move(cart), builder.add_material(matte("cart", {0.33f, 0.23f, 0.16f})), transform);
}

}  // namespace

Scene build_mine(std::string name, float sun_diameter_deg) {
  SceneBuilder builder(std::move(name));
  const Index stone_material = builder.add_material(matte("rock", {0.6f, 0.52f, 0.43f}));
  builder.add("rock", rock(), stone_material);
  const Index earth = builder.add_material(matte("earth", {0.45f, 0.4f, 0.3f}));
  builder.add("ground outside",
              height_field({kMouth - 1.5f, -40}, {90, 40}, 160, 160,
                           [](float x, float z) {
                             return -0.3f + 0.15f * fractal_noise({x * 0.2f, 0, z * 0.2f}, 4, 3);
                           }),
              earth);
  add_stones(builder);
  add_timber(builder);
  add_track(builder);

  Environment environment;
  environment.kind = EnvironmentKind::sun_sky;
  environment.sun_sky.sun_elevation_rad = glm::radians(13.0f);
  environment.sun_sky.sun_azimuth_rad = glm::radians(84.0f);  // nearly along +X, into the mouth
  // 10 degrees include the glow around the sun, as in a small sky map, so that sampled directions can hit it. The
  // sun's irradiance does not depend on its size.
  environment.sun_sky.sun_angular_diameter_rad = glm::radians(sun_diameter_deg);
  builder.set_environment(environment);

  const auto eye = [](float x, float y, float z) { return transform_point(on_track(x), Vec3(0, y, z)); };
  const Vec3 start = eye(1.0f, 1.55f, 0.7f);
  const Vec3 target = eye(9.0f, 0.9f, -0.2f);
  const Index camera = builder.add_camera(start, target, 60);
  builder.add_camera_path(camera, {{0, start, target},
                                   {4, eye(3.0f, 1.6f, 0.9f), eye(10, 1.0f, 0)},
                                   {7, eye(5.5f, 1.6f, 1.0f), eye(12, 1.2f, 0)},
                                   {10, eye(8, 1.6f, 0), eye(18, 1.6f, 0)}});
  return builder.take();
}

}  // namespace relume

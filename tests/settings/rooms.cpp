#include "settings/rooms.h"

#include <string>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/shapes.h"
#include "core/hash.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

constexpr float kHalf = 2;  // half of the room's width and depth, in metres
constexpr float kHeight = 3;

Transform at(const Vec3& position, float turned_deg = 0) {
  Transform transform;
  transform.translation = position;
  transform.rotation = glm::quat_cast(Mat3(rotation_y(turned_deg)));
  return transform;
}

/// Codes that differ between texels: interpolating codes differs from interpolating decoded values.
std::array<int, 4> speckle(int x, int y) {
  const auto code = [x, y](uint32_t channel) {
    return static_cast<int>(hash(static_cast<uint32_t>(x), static_cast<uint32_t>(y), channel) % 256);
  };
  return {code(0), code(1), code(2), 255};
}

void add_walls(SceneBuilder& builder) {
  Texture texture = make_texture(16, 16, PixelFormat::rgba8_srgb, speckle);
  texture.filter = FilterMode::linear;
  Material floor = matte("floor", Rgb(0.8f));
  floor.base_color_texture.texture = builder.add_texture(std::move(texture));
  builder.add("floor", quad({-kHalf, 0, kHalf}, {2 * kHalf, 0, 0}, {0, 0, -2 * kHalf}), builder.add_material(floor));
  const Index white = builder.add_material(matte("white", Rgb(0.7f)));
  builder.add("ceiling", quad({-kHalf, kHeight, -kHalf}, {2 * kHalf, 0, 0}, {0, 0, 2 * kHalf}), white);
  builder.add("back wall", quad({-kHalf, 0, -kHalf}, {2 * kHalf, 0, 0}, {0, kHeight, 0}), white);
  const Index red = builder.add_material(matte("red", {0.6f, 0.1f, 0.1f}));
  builder.add("left wall", quad({-kHalf, 0, kHalf}, {0, 0, -2 * kHalf}, {0, kHeight, 0}), red);
  builder.add("right wall", quad({kHalf, 0, -kHalf}, {0, 0, 2 * kHalf}, {0, kHeight, 0}), white);
  for (const float x : {-0.7f, 0.6f})
    builder.add("partition", box({x, 1.6f, -kHalf}, {x + 0.05f, kHeight, kHalf - 0.3f}), red);
}

void add_objects(SceneBuilder& builder) {
  const Mesh block = box({-0.4f, 0, -0.4f}, {0.4f, 1.1f, 0.4f});
  builder.add("rough metal", block, builder.add_material(metal("rough", {0.8f, 0.7f, 0.5f}, 0.4f)),
              at({-1.2f, 0, -0.6f}, 17));
  builder.add("polished metal", block, builder.add_material(metal("polished", {0.6f, 0.7f, 0.8f}, 0.15f)),
              at({1.2f, 0, -0.4f}, -20));
  builder.add("gloss", block, builder.add_material(glossy("gloss", {0.2f, 0.5f, 0.3f}, 0.35f)), at({0, 0, -1.2f}, 9));
  builder.add("mirror", icosphere(0.4f, 3), builder.add_material(metal("mirror", Rgb(0.9f), 0)), at({-0.5f, 0.4f, 1}));
  builder.add("ball", icosphere(0.4f, 3), builder.add_material(matte("ball", {0.3f, 0.4f, 0.7f})),
              at({0.5f, 0.4f, 0.8f}));
}

/// 60 emissive triangles below the ceiling, and a moving box.
void add_lamps(SceneBuilder& builder) {
  for (int i = 0; i < 30; ++i) {
    const Vec3 corner(-1.7f + 0.66f * static_cast<float>(i % 6), kHeight - 0.2f,
                      -1.7f + 0.75f * static_cast<float>(i / 6));
    const float share = to_unit_float(hash(static_cast<uint32_t>(i), 3u));
    const std::string name = "lamp " + std::to_string(i);
    builder.add(name, quad(corner, {0.15f, 0, 0}, {0, 0, 0.15f}),
                builder.add_material(emitter(name, Rgb(5 + 40 * share, 30, 45 - 40 * share))));
  }
  const Vec3 from(-1.1f, 1.3f, 0.4f);
  AnimationChannel move;
  move.node = builder.add("moving lamp", box({-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.15f}),
                          builder.add_material(emitter("moving lamp", Rgb(80))), at(from));
  move.times = {0, 1};
  move.values = {Vec4(from, 0), Vec4(1.1f, 1.8f, 0, 0)};
  builder.add_channel(std::move(move));
}

}  // namespace

Scene build_busy_room() {
  SceneBuilder builder("busy room");
  add_walls(builder);
  add_objects(builder);
  add_lamps(builder);
  Environment environment;
  environment.kind = EnvironmentKind::sun_sky;
  environment.sun_sky.sky_scale = environment.sun_sky.sun_scale = 1e-4f;
  builder.set_environment(environment);
  builder.set_visible_sets({{{-kHalf, 0, -kHalf}, {0, kHeight, kHalf}, {0, 1}},  // both halves see each other
                            {{0, 0, -kHalf}, {kHalf, kHeight, kHalf}, {0, 1}}});
  builder.add_camera({0.2f, 1.6f, 5.6f}, {0, 1.3f, 0}, 42, "front");
  builder.add_camera({1.8f, 1.4f, 1.9f}, {-0.6f, 0.8f, -0.6f}, 60, "side");
  return builder.take();
}

Scene build_curtain() {
  SceneBuilder builder("curtain");
  AnimationChannel move;
  move.node = builder.add("curtain", quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}),
                          builder.add_material(emitter("curtain", {0.5f, 0.25f, 0.125f})));
  move.times = {0, 1};
  move.values = {Vec4(0), Vec4(10, 0, 0, 0)};
  builder.add_channel(std::move(move));
  builder.add_camera({0, 0, 1}, {0, 0, 0}, 40);
  return builder.take();
}

Scene build_curtain_with_clips() {
  Scene scene = build_curtain();
  scene.clips = {"stay", "go"};
  scene.animation[0].clip = 1;
  return scene;
}

}  // namespace relume::support

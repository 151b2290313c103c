// After the ajar door of [Veach97 ch. 11]: three pots on a table, lit only through the gap of a door that is hardly
// open. Nearly all light in the room was first reflected in the room next door.
#include <cmath>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/rooms.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"

namespace relume {
namespace {

constexpr float kHeight = 2.9f;
constexpr float kTable = 0.8f;     // height of the tabletop
constexpr float kDoorFrom = 0.5f;  // the opening in the wall z = -3, along x
constexpr float kDoorTo = 1.6f;

/// Planks in two browns, 512² texels.
Texture planks() {
  Texture texture;
  texture.name = "planks";
  texture.width = texture.height = 512;
  for (int y = 0; y < texture.height; ++y) {
    for (int x = 0; x < texture.width; ++x) {
      const int plank = x / 64;
      const int shifted = (y + plank * 173) % 512;
      const bool joint = x % 64 < 2 || shifted % 256 < 2;
      const float grain =
          0.5f + 0.5f * std::sin(0.6f * static_cast<float>(x) + 3 * std::sin(0.03f * static_cast<float>(shifted)));
      const float tone =
          joint ? 0.35f : 0.66f + 0.1f * grain + 0.12f * static_cast<float>((plank * 5 + shifted / 256 * 3) % 4) / 3;
      for (const float channel : {tone * 0.95f, tone * 0.72f, tone * 0.5f, 1.0f})
        texture.texels.push_back(static_cast<std::byte>(std::lround(255 * channel)));
    }
  }
  return texture;
}

Mesh torus_arc(const Vec3& centre, float radius, float tube_radius, float from_deg, float to_deg) {
  return parametric_surface(24, 32, [&](float u, float v) {
    const float angle = glm::radians(lerp(from_deg, to_deg, v));
    const Vec3 out(std::cos(angle), std::sin(angle), 0);
    const float turn = 2 * kPi * u;
    return centre + radius * out + tube_radius * (std::cos(turn) * out - std::sin(turn) * Vec3(0, 0, 1));
  });
}

/// A pot 0.3 m high on y = 0 with lid, spout and handle.
Mesh pot() {
  Mesh mesh = lathe({{0, 0},
                     {0.1f, 0},
                     {0.12f, 0.015f},
                     {0.17f, 0.06f},
                     {0.19f, 0.11f},
                     {0.18f, 0.16f},
                     {0.14f, 0.2f},
                     {0.1f, 0.22f},
                     {0.1f, 0.235f},
                     {0.09f, 0.245f},
                     {0.05f, 0.262f},
                     {0.018f, 0.268f},
                     {0.015f, 0.28f},
                     {0.03f, 0.295f},
                     {0.028f, 0.31f},
                     {0.015f, 0.32f},
                     {0, 0.322f}},
                    64);
  append(mesh, torus_arc({-0.17f, 0.125f, 0}, 0.07f, 0.014f, 60, 300));
  const auto spout = [](float u, float v) {
    const float turn = 2 * kPi * u;
    const float r = lerp(0.045f, 0.018f, v);
    const Vec3 along = glm::normalize(Vec3(1, 0.4f + 1.2f * v, 0));
    const Vec3 side(-along.y, along.x, 0);
    const Vec3 middle(0.15f + 0.17f * v, 0.09f + 0.06f * v + 0.09f * v * v, 0);
    return middle + r * (std::cos(turn) * side - std::sin(turn) * Vec3(0, 0, 1));
  };
  append(mesh, flipped(parametric_surface(24, 16, spout)));
  return mesh;
}

void add_table(SceneBuilder& builder) {
  const Index wood = builder.add_material(glossy("table", {0.36f, 0.2f, 0.11f}, 0.3f));
  Mesh table = box({-0.95f, kTable - 0.05f, -0.5f}, {0.95f, kTable, 0.5f});
  for (const float x : {-0.85f, 0.78f}) {
    for (const float z : {-0.42f, 0.35f}) append(table, box({x, -0.01f, z}, {x + 0.07f, kTable - 0.05f, z + 0.07f}));
  }
  Transform place;
  place.translation = {-0.35f, 0, -0.2f};
  builder.add("table", std::move(table), wood, place);

  const Material materials[3] = {glossy("porcelain", {0.75f, 0.74f, 0.72f}, 0.15f), glass("glass", 1.5f),
                                 metal("copper", {0.85f, 0.5f, 0.36f}, 0.2f)};
  for (int i = 0; i < 3; ++i) {
    const float order = static_cast<float>(i);
    Transform transform;
    // The glass pot is half a millimetre above the table: its bottom bounds the glass.
    transform.translation = {-0.98f + 0.62f * order, kTable + (i == 1 ? 0.0005f : -0.001f), -0.2f + 0.1f * (order - 1)};
    transform.rotation = glm::quat_cast(Mat3(rotation_y(25 - 40 * order)));
    // A single closed surface refracts correctly; handle and spout would overlap inside it.
    Mesh mesh = i == 1 ? lathe({{0, 0},
                                {0.11f, 0},
                                {0.17f, 0.06f},
                                {0.19f, 0.11f},
                                {0.18f, 0.16f},
                                {0.14f, 0.2f},
                                {0.08f, 0.23f},
                                {0.07f, 0.27f},
                                {0.09f, 0.3f},
                                {0, 0.31f}},
                               96)
                       : pot();
    builder.add(materials[i].name + " pot", std::move(mesh), builder.add_material(materials[i]), transform);
  }
}

void add_door(SceneBuilder& builder) {
  const Index paint = builder.add_material(glossy("door", {0.4f, 0.42f, 0.36f}, 0.4f));
  const Index brass = builder.add_material(metal("brass", {0.8f, 0.65f, 0.35f}, 0.25f));
  const float width = kDoorTo - kDoorFrom;
  Transform hinge;
  hinge.translation = {kDoorTo, 0, -2.95f};
  hinge.rotation = glm::quat_cast(Mat3(rotation_y(20)));
  const Index leaf = builder.add("door", box({-width, 0.01f, -0.02f}, {0, 2.1f, 0.02f}), paint, hinge);
  Transform knob;
  knob.translation = {-width + 0.08f, 1.0f, 0.06f};
  builder.add("knob", icosphere(0.035f, 4), brass, knob, leaf);
}

}  // namespace

Scene build_door() {
  SceneBuilder builder("door");
  const Index plaster = builder.add_material(matte("plaster", {0.7f, 0.68f, 0.62f}));
  Material planked = glossy("planks", Rgb(0.9f), 0.35f);
  planked.base_color_texture.texture = builder.add_texture(planks());
  planked.base_color_texture.scale = {5, 6};
  const Index floor = builder.add_material(planked);
  // One shell around both rooms, and the wall between them.
  builder.add("walls", room({-3.2f, -0.002f, -6.5f}, {3.2f, kHeight, 3}), plaster);
  builder.add("floor", quad({-3.2f, 0, 3}, {6.4f, 0, 0}, {0, 0, -9.5f}), floor);
  builder.add("wall with door",
              wall({-3.2f, -3}, {3.2f, -3}, 0.1f, kHeight, {{{kDoorFrom + 3.2f, kDoorTo + 3.2f}, {-0.01f, 2.12f}}}),
              plaster);
  add_door(builder);
  add_table(builder);

  const Index frame = builder.add_material(glossy("frame", {0.12f, 0.1f, 0.08f}, 0.3f));
  const Index canvas = builder.add_material(matte("canvas", {0.25f, 0.4f, 0.45f}));
  builder.add("frame", box({-1.7f, 1.25f, -2.96f}, {-0.7f, 2.05f, -2.92f}), frame);
  builder.add("canvas", quad({-1.63f, 1.32f, -2.915f}, {0.86f, 0, 0}, {0, 0.66f, 0}), canvas);

  // On the left of the next room's far wall, so the gap only receives its light at a slant.
  const Index light = builder.add_material(emitter("lamp", {1000, 880, 700}));
  builder.add("lamp", quad({-2.2f, 0.9f, -6.45f}, {1.4f, 0, 0}, {0, 1.4f, 0}), light);
  builder.add_camera({-0.75f, 1.65f, 2.75f}, {0.05f, 0.95f, -1.2f}, 48);
  return builder.take();
}

}  // namespace relume

// After the room with lamps in [Veach97 ch. 10]: a floor lamp hides its bulb from everything except the ceiling, and a
// spotlight in a deep shade lights a glass egg. Most camera paths miss both.
#include "builtin_scenes/builder.h"
#include "builtin_scenes/rooms.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"

namespace relume {
namespace {

Transform at(const Vec3& position) {
  Transform transform;
  transform.translation = position;
  return transform;
}

void add_floor_lamp(SceneBuilder& builder, const Vec3& foot) {
  const Index brass = builder.add_material(metal("brass", {0.78f, 0.62f, 0.35f}, 0.3f));
  const Index light = builder.add_material(emitter("bulb", {620, 545, 430}));
  Mesh stand = lathe({{0.18f, 0}, {0.18f, 0.03f}, {0, 0.03f}}, 64);
  append(stand, transformed(cylinder(0.018f, 1.6f, 32, false), translation({0, 0.02f, 0})));
  // A bowl with an outer and an inner surface, 8 mm apart.
  append(stand, lathe({{0, 1.55f},
                       {0.06f, 1.56f},
                       {0.17f, 1.65f},
                       {0.21f, 1.8f},
                       {0.202f, 1.8f},
                       {0.163f, 1.658f},
                       {0.055f, 1.57f},
                       {0, 1.56f}},
                      96));
  builder.add("floor lamp", std::move(stand), brass, at(foot));
  builder.add("bulb", transformed(disc(0.09f, 48), translation({0, 1.62f, 0})), light, at(foot));
}

/// A shade that opens along its +Y, with the lamp deep inside.
void add_spotlight(SceneBuilder& builder, const Vec3& position, float tilt_deg) {
  const Index black = builder.add_material(matte("shade", Rgb(0.06f)));
  const Index light = builder.add_material(emitter("spot bulb", {4500, 4050, 3300}));
  Transform place = at(position);
  place.rotation = glm::quat_cast(Mat3(rotation(tilt_deg, Vec3(0, 0, 1))));
  const Index shade = builder.add(
      "shade", lathe({{0, -0.008f}, {0.06f, -0.008f}, {0.06f, 0.21f}, {0.055f, 0.21f}, {0.055f, 0}, {0, 0}}, 64), black,
      place);
  builder.add("spot bulb", transformed(disc(0.03f, 48), translation({0, 0.01f, 0})), light, {}, shade);
}

void add_table(SceneBuilder& builder) {
  const Index wood = builder.add_material(glossy("table", {0.45f, 0.3f, 0.18f}, 0.35f));
  Mesh table = transformed(cylinder(0.62f, 0.04f, 96, true), translation({0, 0.7f, 0}));
  append(table, transformed(cylinder(0.05f, 0.71f, 48, false), translation({0, -0.005f, 0})));
  append(table, transformed(cylinder(0.3f, 0.04f, 96, true), translation({0, -0.005f, 0})));
  builder.add("table", std::move(table), wood, at({0.35f, 0, -0.4f}));

  const Index clear = builder.add_material(glass("glass", 1.5f));
  // An egg on its side, half a millimetre above the table.
  builder.add("egg", transformed(icosphere(1, 5), scaling({0.16f, 0.115f, 0.115f})), clear,
              at({0.35f, 0.8555f, -0.35f}));
}

}  // namespace

Scene build_lamp_room() {
  SceneBuilder builder("lamp-room");
  const Index plaster = builder.add_material(matte("plaster", {0.75f, 0.72f, 0.66f}));
  const Index carpet = builder.add_material(matte("carpet", {0.33f, 0.2f, 0.17f}));
  builder.add("walls", room({-2.2f, -0.002f, -2}, {2.2f, 2.7f, 2.4f}), plaster);
  builder.add("floor", quad({-2.2f, 0, 2.4f}, {4.4f, 0, 0}, {0, 0, -4.4f}), carpet);
  add_floor_lamp(builder, {-1.3f, 0, -1.2f});
  // Hangs from the ceiling beside the table and points down at the egg.
  add_spotlight(builder, {1.25f, 1.75f, -0.35f}, 135);
  const Index black = builder.add_material(matte("rod", Rgb(0.06f)));
  builder.add("rod", transformed(cylinder(0.012f, 1.0f, 24, false), translation({1.26f, 1.76f, -0.35f})), black);
  add_table(builder);
  builder.add_camera({0.0f, 1.55f, 2.3f}, {-0.15f, 1.05f, -0.8f}, 58);
  return builder.take();
}

}  // namespace relume

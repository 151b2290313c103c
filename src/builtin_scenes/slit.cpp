// A room lit only through a narrow slit, behind which three coloured lamps move from side to side. Sharp shadows sweep
// quickly over floor and walls.
#include <cmath>
#include <string>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/rooms.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"

namespace relume {
namespace {

constexpr float kSeconds = 8;

/// x = amplitude · sin(2π · cycles · t / kSeconds + phase) about `centre`.
AnimationChannel sway(Index node, const Vec3& centre, float amplitude, float cycles, float phase) {
  AnimationChannel channel;
  channel.node = node;
  const int steps = static_cast<int>(kSeconds * 20);
  for (int i = 0; i <= steps; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(steps);
    channel.times.push_back(t * kSeconds);
    channel.values.emplace_back(centre + Vec3(amplitude * std::sin(2 * kPi * cycles * t + phase), 0, 0), 0);
  }
  return channel;
}

}  // namespace

Scene build_slit() {
  SceneBuilder builder("slit");
  const Index plaster = builder.add_material(matte("plaster", {0.75f, 0.74f, 0.71f}));
  const Index floor = builder.add_material(matte("floor", {0.55f, 0.5f, 0.44f}));
  const Index dark = builder.add_material(matte("screen", {0.3f, 0.31f, 0.33f}));
  constexpr float kHeight = 3.2f;
  builder.add("walls", room({-4, 0, -6}, {4, kHeight, 4}), plaster);
  builder.add("floor", quad({-4, 0.002f, 4}, {8, 0, 0}, {0, 0, -10}), floor);
  builder.add("screen", wall({-4, -2}, {4, -2}, 0.1f, kHeight, {{{3.86f, 4.14f}, {0.2f, 2.9f}}}), dark);

  const Index blue = builder.add_material(glossy("column", {0.25f, 0.35f, 0.5f}, 0.3f));
  const Index ochre = builder.add_material(matte("ball", {0.65f, 0.45f, 0.15f}));
  builder.add("column", transformed(cylinder(0.22f, 2.0f, 64, true), translation({-1.3f, -0.01f, 0.5f})), blue);
  builder.add("low column", transformed(cylinder(0.3f, 0.7f, 64, true), translation({0.9f, -0.01f, -0.4f})), blue);
  builder.add("ball", transformed(icosphere(0.4f, 5), translation({0.35f, 0.4f, 1.2f})), ochre);

  const Rgb colors[3] = {{1300, 420, 260}, {360, 950, 450}, {320, 520, 1400}};
  for (int i = 0; i < 3; ++i) {
    const float order = static_cast<float>(i);
    const std::string name = "lamp " + std::to_string(i);
    const Index material = builder.add_material(emitter(name, colors[i]));
    const Vec3 centre(0, 0.8f + 0.7f * order, -3.2f - 0.6f * order);
    Transform transform;
    AnimationChannel channel = sway(kNone, centre, 2.2f, 1 + order, 0.4f + 2.1f * order);
    transform.translation = Vec3(channel.values.front());
    channel.node = builder.add(name, quad({-0.2f, -0.2f, 0}, {0.4f, 0, 0}, {0, 0.4f, 0}), material, transform);
    builder.add_channel(std::move(channel));
  }

  builder.add_camera({3.1f, 2.2f, 3.6f}, {-0.4f, 0.75f, -0.8f}, 55);
  const std::vector<CameraKey> keys{{0, {3.1f, 2.2f, 3.6f}, {-0.4f, 0.75f, -0.8f}},
                                    {4, {0, 1.6f, 3.2f}, {0, 0.75f, -0.8f}},
                                    {kSeconds, {-3.1f, 1.9f, 2.6f}, {0.4f, 0.7f, -0.4f}}};
  builder.add_camera_path(builder.add_camera(keys.front().eye, keys.front().target, 55, "past"), keys);
  return builder.take();
}

}  // namespace relume

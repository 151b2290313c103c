#include <gtest/gtest.h>

#include <functional>

#include "builtin_scenes/builtin.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "render/session.h"

namespace relume {
namespace {

RenderSettings small_settings() {
  RenderSettings settings;
  settings.width = 24;
  settings.height = 24;
  settings.threads = 1;
  return settings;
}

ErrorCode code_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.code();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorCode::io;
}

double mean_luminance(const Image& image) {
  double sum = 0;
  for (const Rgb& c : image.pixels) sum += static_cast<double>(luminance(c));
  return sum / static_cast<double>(image.pixels.size());
}

double rendered_luminance(Session& session) {
  for (int i = 0; i < 16; ++i) session.render_frame();
  return mean_luminance(session.image());
}

/// A card that fills the view of cornell's camera and emits `radiance`.
struct Card {
  Card(Session& session, float radiance) {
    Material material;
    material.emission = Rgb(radiance);
    material.base_color = Rgb(0);
    material.specular = 0;
    material.double_sided = true;
    Mesh mesh;
    mesh.positions = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    mesh.triangles = {{0, 1, 2}};
    mesh.material = session.add_material(material).index;
    card = session.add_mesh(mesh);
    const CameraPose camera = session.camera();
    Node place;
    place.meshes = {card.index};
    place.matrix = camera.to_world;
    (*place.matrix)[3] -= 0.5f * camera.to_world[2];
    node = session.add_node(place);
  }
  MeshHandle card;
  NodeHandle node;
};

TEST(SessionEdit, ShowsAddedMovedAndRemovedNodes) {
  Session session(find_builtin_scene("cornell")->build(), small_settings());
  const double before = rendered_luminance(session);
  Card card(session, 7);
  EXPECT_NEAR(rendered_luminance(session), 7, 1e-4);
  session.set_transform(card.node, {.translation = {0, 1000, 0}});
  EXPECT_LT(rendered_luminance(session), 6);
  session.remove(card.node);
  EXPECT_NEAR(rendered_luminance(session), before, 0.1 * before);
  EXPECT_NO_THROW(session.remove(card.card));
}

TEST(SessionEdit, EveryTechniqueSupportsEdits) {
  for (const char* json : {R"({"cache": "apsf+apg"})", R"({"lights": "vlc", "guide": "cdq"})",
                           R"({"lights": "static-lists", "static-lists.rays": 64})", R"({"lights": "neeat"})",
                           R"({"history": "reproject", "allocation": "adaptive"})", R"({"denoise": "bmfr"})",
                           R"({"estimator": "bdpt"})"}) {
    Settings settings = small_settings();
    settings.apply_json(json, json);
    Session session(find_builtin_scene("cornell")->build(), settings);
    for (int i = 0; i < 3; ++i) session.render_frame();
    const Card card(session, 3);
    EXPECT_NEAR(rendered_luminance(session), 3, 0.05) << json;
    session.remove(card.node);
    EXPECT_LT(rendered_luminance(session), 2) << json;
  }
}

TEST(SessionEdit, KeepsTheImageUntilTheNextFrame) {
  Session session(find_builtin_scene("cornell")->build(), small_settings());
  session.render_frame();
  const Image before = session.image();
  const Card card(session, 7);
  EXPECT_EQ(session.image().pixels, before.pixels);
  session.set_transform(card.node, {.translation = {0, 2, 0}});
  EXPECT_EQ(session.image().pixels, before.pixels);
}

TEST(SessionEdit, ErrorsOfUnnamedScenesBeginWithAPlace) {
  Scene scene = find_builtin_scene("cornell")->build();
  scene.name.clear();
  Session session(std::move(scene), small_settings());
  try {
    session.set_light(99, {});
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("scene: light 99 does not exist; ")) << error.what();
  }
}

TEST(SessionEdit, HandlesAreChecked) {
  Session session(find_builtin_scene("cornell")->build(), small_settings());
  Session other(find_builtin_scene("cornell")->build(), small_settings());
  const Card card(session, 1);
  EXPECT_EQ(code_of([&] { other.set_transform(card.node, {}); }), ErrorCode::invalid_handle);
  EXPECT_EQ(code_of([&] { session.remove(card.card); }), ErrorCode::invalid_input) << "a node has it";
  session.remove(card.node);
  EXPECT_EQ(code_of([&] { session.set_transform(card.node, {}); }), ErrorCode::invalid_handle);
  EXPECT_EQ(code_of([&] { session.remove(card.node); }), ErrorCode::invalid_handle);
  session.remove(card.card);
  Node node;
  node.meshes = {card.card.index};
  EXPECT_EQ(code_of([&] { session.add_node(node); }), ErrorCode::invalid_handle);
  EXPECT_EQ(code_of([&] { session.set_light(99, {}); }), ErrorCode::invalid_handle);
}

TEST(SessionEdit, OtherChangesMayFollowBeforeAFrame) {
  Session session(find_builtin_scene("cornell")->build(), small_settings());
  session.render_frame();
  const Card card(session, 7);
  RenderSettings settings = small_settings();
  settings.width = 32;
  ASSERT_TRUE(session.set_settings(settings));
  EXPECT_NEAR(rendered_luminance(session), 7, 1e-4);
  const Card second(session, 7);
  session.restart(5);
  EXPECT_NEAR(rendered_luminance(session), 7, 1e-4);
}

TEST(SessionEdit, RejectsObjectsBeyondTheLimitAndContinues) {
  Session session(find_builtin_scene("cornell")->build(), small_settings());
  const double before = rendered_luminance(session);
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  Node node;
  node.meshes = {session.add_mesh(mesh).index};
  node.transform.scale = Vec3(1e10f);
  EXPECT_EQ(code_of([&] { session.add_node(node); }), ErrorCode::invalid_input);
  EXPECT_NEAR(rendered_luminance(session), before, 0.1 * before);
}

TEST(SessionEdit, EditedScenesCannotUseCheckpoints) {
  Session session(find_builtin_scene("cornell")->build(), small_settings());
  const Card card(session, 7);
  session.render_frame();
  const TempFolder folder;
  EXPECT_EQ(code_of([&] { session.save_checkpoint(folder / "a.ckpt"); }), ErrorCode::not_supported);
  EXPECT_EQ(code_of([&] { session.load_checkpoint(folder / "a.ckpt"); }), ErrorCode::not_supported);
}

TEST(SessionEdit, NodesAreFoundByName) {
  const Session session(find_builtin_scene("cornell")->build(), small_settings());
  const NodeHandle lamp = session.find_node("lamp");
  EXPECT_EQ(compiled_scene(session).source().nodes[static_cast<size_t>(lamp.index)].name, "lamp");
  EXPECT_EQ(code_of([&] { session.find_node("no such node"); }), ErrorCode::not_found);
}

}  // namespace
}  // namespace relume

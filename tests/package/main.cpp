// Creates a scene, writes and reads it as a file, renders it and writes the image. These parts of the library have
// different dependencies.
#include <filesystem>
#include <iostream>

#include <relume/relume.h>

namespace {

/// A card that emits (0.5, 0.25, 0.125) and fills the view.
relume::Scene card() {
  relume::Scene scene;
  scene.materials.push_back({.name = "card", .base_color = {0.5f, 0.25f, 0.125f}, .unlit = true});
  scene.meshes.push_back(
      {.name = "card", .positions = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, .triangles = {{0, 1, 2}}, .material = 0});
  scene.cameras.push_back({.name = "camera"});
  scene.add_node({.name = "card", .meshes = {0}});
  scene.add_node({.name = "camera", .transform = {.translation = {0, 0, 2}}, .camera = 0});
  return scene;
}

}  // namespace

int main() {
  const std::filesystem::path folder = std::filesystem::current_path();
  relume::write_gltf(folder / "card.glb", card());
  relume::Settings settings;
  settings.set("width", 8).set("height", 4);
  relume::Session session(relume::load_scene(folder / "card.glb"), settings);
  session.render_frame();
  relume::write_image(folder / "card.exr", session.image());
  const relume::Image image = relume::read_image(folder / "card.exr");
  for (const relume::Rgb& pixel : image.pixels) {
    if (pixel == relume::Rgb(0.5f, 0.25f, 0.125f)) continue;
    std::cout << "the image shows " << pixel.r << ' ' << pixel.g << ' ' << pixel.b << '\n';
    return 1;
  }
  return 0;
}

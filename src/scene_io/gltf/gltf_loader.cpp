#include "scene_io/gltf/gltf_loader.h"

#include "scene_io/gltf/gltf_extras.h"
#include "scene_io/gltf/gltf_image_light.h"
#include "scene_io/gltf/gltf_nodes.h"
#include "scene_io/gltf/gltf_skins.h"
#include "scene_io/gltf/gltf_variants.h"

namespace relume {

Scene load_gltf_from_memory(std::span<const std::byte> file, const std::filesystem::path& base_dir,
                            const std::string& place) {
  gltf::Document document(place);
  gltf::read_document(file, base_dir, document);
  Scene scene;
  scene.environment.kind = EnvironmentKind::automatic;
  scene.name = std::filesystem::path(place).stem().string();
  scene.variants = gltf::variant_names(document);
  gltf::MaterialImporter materials(document, scene);
  gltf::MeshImporter meshes(document, scene, materials);
  gltf::PunctualImporter punctual(document);
  gltf::SceneIndices indices{.nodes = gltf::import_nodes(document, scene, meshes, punctual),
                             .material = [&](int i) { return materials.find(i); },
                             .light = [&](int i) { return punctual.find_light(i); },
                             .camera = [&](int i) { return punctual.find_camera(i); }};
  gltf::import_skins(document, indices.nodes, scene);
  gltf::import_animation(document, indices, scene);
  meshes.finish();
  gltf::drop_unusable_skins(document, scene);
  gltf::drop_missing_targets(document, scene);
  gltf::drop_empty_clips(scene);
  materials.finish();
  gltf::import_image_light(document, scene);
  gltf::apply_scene_extras(document, scene);
  scene.warnings = document.warnings.take();
  scene.notes = document.warnings.take_notes();
  validate(scene, place);
  return scene;
}

Scene load_gltf(const std::filesystem::path& file) {
  const Bytes bytes = read_file_bytes(file);
  return load_gltf_from_memory(bytes, file.parent_path(), file.string());
}

}  // namespace relume

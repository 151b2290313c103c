#include "scene_io/mitsuba/mitsuba_loader.h"

#include <fmt/format.h>

#include "files/bytes.h"
#include "scene_io/decompose.h"
#include "scene_io/mitsuba/mitsuba_emitters.h"
#include "scene_io/mitsuba/mitsuba_sensors.h"
#include "scene_io/mitsuba/mitsuba_shapes.h"

namespace relume {
namespace {

using mitsuba::Import;
using mitsuba::Object;

/// Node above all others; kNone if nothing is turned.
Index add_root(const glm::dmat4& turn, Scene& scene) {
  if (turn == glm::dmat4(1)) return kNone;
  Node root;
  root.name = "turn";
  root.transform = decompose(Mat4(turn));
  return scene.add_node(std::move(root));
}

void import_objects(Import& import) {
  import.turn = mitsuba::turn_of_scene(import);
  const Index root = add_root(import.turn, import.scene);
  mitsuba::Textures textures(import);
  mitsuba::Shapes shapes(import, textures);
  const mitsuba::Parameters scene(import, *import.document.root);
  for (const Object* object : scene.children({"shape"})) shapes.add(*object, root);
  shapes.finish(root);
  for (const Object* object : scene.children({"emitter"})) mitsuba::import_emitter(*object, root, import);
  for (const Object* object : scene.children({"sensor"})) mitsuba::import_sensor(*object, root, import);
  mitsuba::import_integrators(scene, import);
  scene.children({"bsdf", "texture", "spectrum"});  // used through references
  textures.finish();
  mitsuba::warn_about_unused(import);
}

}  // namespace

Scene load_mitsuba_from_memory(std::span<const std::byte> file, const std::filesystem::path& base_dir,
                               const std::string& place) {
  Scene scene;
  scene.environment.kind = EnvironmentKind::automatic;
  scene.name = std::filesystem::path(place).stem().string();
  Warnings warnings(place);
  mitsuba::Files files(base_dir);
  Import import{mitsuba::read_document(file, files, place, warnings), files, scene, warnings, glm::dmat4(1)};
  import_objects(import);
  scene.warnings = warnings.take();
  scene.notes = warnings.take_notes();
  validate(scene, place);
  return scene;
}

Scene load_mitsuba(const std::filesystem::path& file) {
  return load_mitsuba_from_memory(read_file_bytes(file, mitsuba::kMaxTextBytes), file.parent_path(), file.string());
}

}  // namespace relume

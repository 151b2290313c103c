// Imports cameras and punctual lights of a glTF file.
#pragma once

#include <map>

#include "scene/scene.h"
#include "scene_io/gltf/gltf_document.h"

namespace relume::gltf {

class PunctualImporter {
 public:
  explicit PunctualImporter(Document& document) : document_(document) {}

  /// Index in Scene::cameras of glTF camera `camera`; kNone with a warning if unusable.
  Index import_camera(int camera, Scene& scene);
  /// Index in Scene::lights of light `light` of KHR_lights_punctual; kNone with a warning if unusable.
  Index import_light(int light, Scene& scene);

  /// Index of an imported camera or light; kNone for others.
  Index find_camera(int camera) const;
  Index find_light(int light) const;

 private:
  Document& document_;
  std::map<int, Index> cameras_;
  std::map<int, Index> lights_;
};

}  // namespace relume::gltf

// Materials of Mitsuba's shapes: a BSDF with the emission of an area light.
#pragma once

#include <tuple>

#include "scene_io/mitsuba/mitsuba_surfaces.h"

namespace relume::mitsuba {

/// Radiance of an area light; black: none.
struct Emission {
  Rgb radiance{0};
  std::optional<TextureSource> texture;

  bool is_black() const { return relume::is_black(radiance); }
};

class Materials {
 public:
  Materials(Import& import, Textures& textures) : import_(import), textures_(textures) {}

  /// Emission of an "area" plugin. A texture's radiance is multiplied by the texture.
  Emission emission(const Object& emitter);

  /// Index of the material of a surface with this emission. `stretch`: of the shape that it covers, for bump maps.
  Index find(const Surface& surface, const Emission& emission, const Object* emitter, const Vec2& stretch);

 private:
  Material finish(const Surface& surface, const Emission& emission, const Vec2& stretch);

  Import& import_;
  Textures& textures_;
  std::map<std::tuple<const Surface*, const Object*, float, float>, Index> known_;
};

}  // namespace relume::mitsuba

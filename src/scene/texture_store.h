// Textures in the layout of kernels: 4 × 4 blocks, mip levels.
#pragma once

#include <cstddef>
#include <span>

#include "core/array.h"
#include "materials/texture.h"
#include "scene/scene.h"

namespace relume {

class TextureStore {
 public:
  /// No textures.
  explicit TextureStore(Memory& memory = host_memory()) : records_(memory), texels_(memory), srgb_table_(memory) {}
  /// Converts all textures, in parallel.
  TextureStore(std::span<const Texture> textures, TextureFilter filter, Memory& memory = host_memory());

  TexturesView view() const { return {records_.view(), texels_.view(), srgb_table_.view()}; }
  /// A texture for host code, until the next launch.
  TextureSampler operator[](size_t i) const;
  /// Makes the arrays of view() readable by the host until the next launch.
  void open_for_host() const;
  size_t memory_bytes() const { return records_.memory_bytes() + texels_.memory_bytes() + srgb_table_.memory_bytes(); }

 private:
  Array<TextureRecord> records_;
  Array<TexelBytes> texels_;  ///< texels of all textures, in the order of the records
  Array<float> srgb_table_;   ///< linear value of each 8-bit sRGB code (IEC 61966-2-1)
};

}  // namespace relume

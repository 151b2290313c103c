// Textures in the layout of kernels: 4 × 4 blocks, mip levels.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/array.h"
#include "materials/texture.h"
#include "scene/scene.h"

namespace relume {

/// 16 bytes of texels. Textures may have more bytes than an array may have elements.
struct alignas(16) TexelBytes {
  std::byte bytes[16];
};

class TextureStore {
 public:
  /// No textures.
  explicit TextureStore(Memory& memory = host_memory()) : views_(memory) {}
  /// Converts all textures, in parallel.
  TextureStore(std::span<const Texture> textures, TextureFilter filter, Memory& memory = host_memory());

  View<const TextureView> views() const { return views_.view(); }
  const TextureView& operator[](size_t i) const { return views_.read()[i]; }
  /// Makes views and texels readable by the host until the next launch.
  void open_for_host() const;
  size_t size() const { return views_.size(); }
  size_t memory_bytes() const;

 private:
  std::vector<Array<TexelBytes>> texels_;
  Array<TextureView> views_;
};

/// Linear value of each 8-bit sRGB code (IEC 61966-2-1).
const float* srgb_to_linear_table();

}  // namespace relume

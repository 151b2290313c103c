// Textures in the layout of kernels: 4 × 4 blocks, mip levels.
#pragma once

#include <span>
#include <vector>

#include "materials/texture.h"
#include "scene/scene.h"

namespace relume {

class TextureStore {
 public:
  TextureStore() = default;
  /// Converts all textures, in parallel.
  TextureStore(std::span<const Texture> textures, TextureFilter filter);

  View<const TextureView> views() const { return view_of(views_); }
  const TextureView& operator[](size_t i) const { return views_[i]; }
  size_t size() const { return views_.size(); }
  size_t memory_bytes() const;

 private:
  std::vector<std::vector<std::byte>> texels_;
  std::vector<TextureView> views_;
};

/// Linear value of each 8-bit sRGB code (IEC 61966-2-1).
const float* srgb_to_linear_table();

}  // namespace relume

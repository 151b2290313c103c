// From the bytes of an image file to a texture, for scene loaders.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// Decodes PNG, JPEG, TGA or BMP to 8 bits a channel; `name` is used in messages. Throws Error.
Texture decode_texture(std::span<const std::byte> bytes, const std::string& name, PixelFormat wanted);

}  // namespace relume

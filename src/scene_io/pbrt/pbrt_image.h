// Images of pbrt's textures.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "files/bytes.h"
#include "relume/image.h"
#include "scene_io/pbrt/pbrt_parameters.h"
#include "scene_io/texture_decode.h"

namespace relume::pbrt {

/// How pbrt's integer images encode values: a transfer function, or a power.
struct Encoding {
  bool srgb = false;
  float gamma = 1;  ///< without `srgb`: value = code^gamma

  float decode(float code) const;
};

/// A decoded image file.
struct ImageFile {
  Texture texels;        ///< rgba8_linear as stored, or rgba32_float
  bool is_coded = true;  ///< whether values have an Encoding; not those of EXR and HDR
  bool has_alpha = false;
  std::shared_ptr<const Bytes> bytes;

  /// Values of texel (x, y) inside the image, RGB decoded.
  Vec4 at(int x, int y, const Encoding& encoding) const;
};

/// Reads each image once, within a DecodeBudget.
class ImageFiles {
 public:
  ImageFiles(std::filesystem::path base_dir, Warnings& warnings)
      : base_dir_(std::move(base_dir)), warnings_(warnings) {}

  /// nullptr, with a warning, if the image cannot be read.
  std::shared_ptr<const ImageFile> read(const std::string& name, const Location& where);
  /// Linear pixels of a light's image; empty, with a warning, if it cannot be read.
  std::optional<Image> read_light(const std::string& name, const Location& where);

 private:
  ImageFile decode(const std::string& name, const Location& where);

  std::filesystem::path base_dir_;
  Warnings& warnings_;
  std::map<std::string, std::shared_ptr<const ImageFile>> files_;
  DecodeBudget budget_;
};

}  // namespace relume::pbrt

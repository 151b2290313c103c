// A frame on the GPU: values are uploaded once per frame, and a shader converts them to display colours.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/vec.h"
#include "relume/tone_map.h"
#include "viewer/render/display_transform.h"
#include "viewer/render/gl.h"

namespace relume::viewer {

/// Shader, display table and palette, shared by all images. Needs a current OpenGL context during its lifetime.
class DisplayShader {
 public:
  DisplayShader();
  ~DisplayShader();
  DisplayShader(const DisplayShader&) = delete;
  DisplayShader& operator=(const DisplayShader&) = delete;

  GLuint nearest_sampler() const { return nearest_; }

 private:
  friend class GlImage;
  /// Binds the table, or that of the tone map.
  void use_table(const DisplayTransform& wish);

  GLuint program_ = 0;
  GLuint vertex_array_ = 0;
  GLuint table_ = 0;    ///< 3D: DisplayTable
  GLuint palette_ = 0;  ///< 2D, one row
  GLuint nearest_ = 0;  ///< sampler
  int table_size_ = 0;
  std::optional<std::pair<const DisplayTable*, ToneMap>> table_of_;
};

class GlImage {
 public:
  GlImage();
  ~GlImage();
  GlImage(const GlImage&) = delete;
  GlImage& operator=(const GlImage&) = delete;

  void upload(const std::vector<Rgb>& values, int width, int height);
  /// Renders the values into texture(). Returns false if values and transform are unchanged.
  bool to_display(DisplayShader& display_shader, const DisplayTransform& wish);

  GLuint texture() const { return developed_; }
  bool empty() const { return width_ == 0; }

 private:
  GLuint values_ = 0;
  GLuint developed_ = 0;
  GLuint frame_ = 0;
  int width_ = 0;
  int height_ = 0;
  bool fresh_ = false;
  DisplayTransform done_;
};

}  // namespace relume::viewer

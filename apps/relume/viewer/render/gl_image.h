// A frame in textures: values are written once per frame, by the host or by the GPU that renders, and a shader converts
// them to display colours.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/vec.h"
#include "relume/tone_map.h"
#include "viewer/render/display_transform.h"
#include "viewer/render/frame_texture.h"
#include "viewer/render/gl.h"
#include "viewer/render/request.h"

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

  /// Takes the values of a frame: those of the inspected buffer, or the image. Keeps its values if a GPU has failed.
  void show(const ViewerFrame& frame);
  /// Renders the values into texture(). Returns false if values and transform are unchanged.
  bool to_display(DisplayShader& display_shader, const DisplayTransform& wish);

  GLuint texture() const { return developed_; }
  bool empty() const { return width_ == 0; }

 private:
  void show_device_image(const ViewerFrame& frame);
  void upload(const Rgb* values, int width, int height);
  /// Notes new values, and gives the other texture their size.
  void take(int width, int height, bool from_device);

  GLuint values_ = 0;           ///< RGB, uploaded by the host
  GLuint channels_ = 0;         ///< one channel, written by a GPU: three texels for each pixel
  FrameTexture frame_texture_;  ///< gives GPUs access to `channels_`
  bool from_device_ = false;    ///< whether `channels_` has the values
  IVec2 uploaded_{0};           ///< size of `values_`
  GLuint developed_ = 0;
  GLuint frame_ = 0;
  int width_ = 0;
  int height_ = 0;
  bool fresh_ = false;
  DisplayTransform done_;
};

}  // namespace relume::viewer

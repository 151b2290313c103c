#include "viewer/render/gl_image.h"

#include <array>
#include <cmath>
#include <span>
#include <string>

#include "relume/error.h"
#include "viewer/render/display_table.h"
#include "viewer/render/frame_pixels.h"

namespace relume::viewer {
namespace {

constexpr int kPaletteSize = 256;

constexpr const char* kVertexShader = R"(#version 330 core
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

constexpr const char* kFragmentShader = R"(#version 330 core
uniform sampler2D values;
uniform sampler3D table;
uniform sampler2D palette;
uniform bool one_channel;  // values has three texels for each pixel
uniform int mode;
uniform int channel;
uniform float scale;
uniform vec2 range;
uniform vec3 table_ev;  // minimum, maximum, size
out vec4 color;

vec3 srgb_from_linear(vec3 c) {
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}

vec3 to_display(vec3 radiance) {
  vec3 ev = log2(max(radiance * scale, vec3(1e-9)));
  vec3 t = clamp((ev - table_ev.x) / (table_ev.y - table_ev.x), 0.0, 1.0);
  return texture(table, (t * (table_ev.z - 1.0) + 0.5) / table_ev.z).rgb;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 v;
  if (one_channel) {
    for (int c = 0; c < 3; ++c) v[c] = texelFetch(values, ivec2(3 * pixel.x + c, pixel.y), 0).r;
  } else {
    v = texelFetch(values, pixel, 0).rgb;
  }
  vec3 in_range = (v - range.x) / max(range.y - range.x, 1e-30);
  float chosen = channel < 0 ? (length(v) - range.x) / max(range.y - range.x, 1e-30) : in_range[max(channel, 0)];
  vec3 c = to_display(v);
  if (mode == 1) c = srgb_from_linear(clamp(in_range, 0.0, 1.0));
  if (mode == 2) c = texture(palette, vec2(clamp(chosen, 0.0, 1.0) * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
  if (mode == 3) c = clamp(v * 0.5 + 0.5, 0.0, 1.0);
  // Makes non-finite values conspicuous.
  if (any(isnan(v)) || any(isinf(v))) c = vec3(1.0, 0.0, 1.0);
  color = vec4(c, 1.0);
}
)";

GLuint compile(GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint done = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  if (done != 0) return shader;
  std::array<char, 1024> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw Error(std::string("the graphics driver cannot compile the viewer's shader; update the driver (") + log.data() +
              ")");
}

GLuint link() {
  const GLuint vertex = compile(GL_VERTEX_SHADER, kVertexShader);
  const GLuint fragment = compile(GL_FRAGMENT_SHADER, kFragmentShader);
  const GLuint program = glCreateProgram();
  glAttachShader(program, vertex);
  glAttachShader(program, fragment);
  glLinkProgram(program);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  GLint done = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &done);
  if (done == 0) throw Error("the graphics driver cannot link the viewer's shader; update the driver");
  return program;
}

/// Gives a texture room for texels of one float. Returns 0 if it cannot be that large.
uint32_t allocate_channels(GLuint texture, int width, int height) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  if (width > most || height > most) return 0;
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, width, height, 0, GL_RED, GL_FLOAT, nullptr);
  return texture;
}

GLuint make_texture(GLenum target, GLint filter) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(target, texture);
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, filter);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(target, axis, GL_CLAMP_TO_EDGE);
  return texture;
}

}  // namespace

DisplayShader::DisplayShader() : program_(link()) {
  glGenVertexArrays(1, &vertex_array_);
  table_ = make_texture(GL_TEXTURE_3D, GL_LINEAR);
  palette_ = make_texture(GL_TEXTURE_2D, GL_LINEAR);
  std::vector<Rgb> colors;
  for (int i = 0; i < kPaletteSize; ++i)
    colors.push_back(palette_color(static_cast<float>(i) / static_cast<float>(kPaletteSize - 1)));
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB32F, kPaletteSize, 1, 0, GL_RGB, GL_FLOAT, colors.data());
  glGenSamplers(1, &nearest_);
  glSamplerParameteri(nearest_, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glSamplerParameteri(nearest_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

DisplayShader::~DisplayShader() {
  glDeleteSamplers(1, &nearest_);
  glDeleteTextures(1, &palette_);
  glDeleteTextures(1, &table_);
  glDeleteVertexArrays(1, &vertex_array_);
  glDeleteProgram(program_);
}

void DisplayShader::use_table(const DisplayTransform& wish) {
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_3D, table_);
  const std::pair source(wish.table, wish.tone_map);
  if (table_of_ == source) return;
  const DisplayTable of_tone_map = wish.table ? DisplayTable{} : display_table(wish.tone_map);
  const DisplayTable& table = wish.table ? *wish.table : of_tone_map;
  glTexImage3D(GL_TEXTURE_3D, 0, GL_RGB32F, table.size, table.size, table.size, 0, GL_RGB, GL_FLOAT,
               table.colors.data());
  table_size_ = table.size;
  table_of_ = source;
}

GlImage::GlImage()
    : frame_texture_([this](int width, int height) { return allocate_channels(channels_, width, height); }) {
  values_ = make_texture(GL_TEXTURE_2D, GL_NEAREST);
  channels_ = make_texture(GL_TEXTURE_2D, GL_NEAREST);
  developed_ = make_texture(GL_TEXTURE_2D, GL_LINEAR);
  glGenFramebuffers(1, &frame_);
}

GlImage::~GlImage() {
  glDeleteFramebuffers(1, &frame_);
  glDeleteTextures(1, &developed_);
  frame_texture_.close();
  glDeleteTextures(1, &channels_);
  glDeleteTextures(1, &values_);
}

void GlImage::show(const ViewerFrame& frame) {
  if (!frame.values.empty()) return upload(frame.values.data(), frame.width, frame.height);
  if (frame.device_image) return show_device_image(frame);
  upload(frame.radiance.data(), frame.width, frame.height);
}

void GlImage::show_device_image(const ViewerFrame& frame) {
  DeviceImage& image = *frame.device_image;
  if (frame_texture_.write(image, frame.width, frame.height)) return take(frame.width, frame.height, true);
  if (const std::span<const std::byte> bytes = image.bytes(); !bytes.empty())
    return upload(reinterpret_cast<const Rgb*>(bytes.data()), frame.width, frame.height);
  const std::vector<Rgb> pixels = radiance_of(frame);
  if (!pixels.empty()) upload(pixels.data(), frame.width, frame.height);
}

void GlImage::upload(const Rgb* values, int width, int height) {
  glBindTexture(GL_TEXTURE_2D, values_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  if (IVec2(width, height) != uploaded_) {
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB32F, width, height, 0, GL_RGB, GL_FLOAT, values);
    uploaded_ = {width, height};
  } else {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGB, GL_FLOAT, values);
  }
  take(width, height, false);
}

void GlImage::take(int width, int height, bool from_device) {
  from_device_ = from_device;
  fresh_ = true;
  if (width == width_ && height == height_) return;
  width_ = width;
  height_ = height;
  glBindTexture(GL_TEXTURE_2D, developed_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
}

bool GlImage::to_display(DisplayShader& display_shader, const DisplayTransform& wish) {
  if (width_ == 0 || (!fresh_ && wish == done_)) return false;
  fresh_ = false;
  done_ = wish;
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, developed_, 0);
  glViewport(0, 0, width_, height_);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glUseProgram(display_shader.program_);
  const auto uniform = [&](const char* name) { return glGetUniformLocation(display_shader.program_, name); };
  glUniform1i(uniform("values"), 0);
  glUniform1i(uniform("table"), 1);
  glUniform1i(uniform("palette"), 2);
  glUniform1i(uniform("one_channel"), from_device_ ? 1 : 0);
  glUniform1i(uniform("mode"), static_cast<int>(wish.mode));
  glUniform1i(uniform("channel"), wish.channel);
  glUniform1f(uniform("scale"), std::exp2(wish.exposure));
  glUniform2f(uniform("range"), wish.range.x, wish.range.y);
  display_shader.use_table(wish);
  glUniform3f(uniform("table_ev"), kTableMinEv, kTableMaxEv, static_cast<float>(display_shader.table_size_));
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_2D, display_shader.palette_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, from_device_ ? channels_ : values_);
  glBindVertexArray(display_shader.vertex_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return true;
}

}  // namespace relume::viewer

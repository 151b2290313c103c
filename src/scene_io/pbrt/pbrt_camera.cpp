#include "scene_io/pbrt/pbrt_camera.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "core/vec.h"
#include "scene_io/decompose.h"

namespace relume::pbrt {
namespace {

/// Width and height of pbrt's film.
IVec2 film_size(const Parameters& film) {
  return {std::clamp(film.integer("xresolution", 1280), 1, 32768),
          std::clamp(film.integer("yresolution", 720), 1, 32768)};
}

/// Part of the film in whole pixels; the whole film if none is given, or an empty one.
ImagePart crop_window(const Parameters& film, const IVec2& size) {
  IVec2 low(0), high = size;
  const std::vector<double> bounds = film.numbers("pixelbounds");
  const std::vector<double> crop = film.numbers("cropwindow");  // takes precedence
  for (int c = 0; c < 2; ++c) {
    const auto at = static_cast<size_t>(2 * c);
    const auto side = static_cast<float>(size[c]);
    const auto pixel = [&](double value) { return value > 0 ? static_cast<int>(std::min(narrow(value), side)) : 0; };
    if (crop.size() == 4) {
      low[c] = pixel(std::ceil(side * narrow(std::min(crop[at], crop[at + 1]))));
      high[c] = pixel(std::ceil(side * narrow(std::max(crop[at], crop[at + 1]))));
    } else if (bounds.size() == 4) {
      low[c] = pixel(bounds[at]);
      high[c] = pixel(bounds[at + 1]);
    }
  }
  if (high.x <= low.x || high.y <= low.y) return {};
  const Vec2 from = Vec2(low) / Vec2(size);
  const Vec2 to = Vec2(high) / Vec2(size);
  return {.left = from.x, .top = from.y, .right = to.x, .bottom = to.y};
}

/// Half extent of the image at distance 1 for a field of view of 90°, and its centre.
struct Screen {
  Vec2 half;
  Vec2 centre{0};
};

Screen screen_of(const Parameters& camera, const IVec2& size, Warnings& warnings) {
  const float aspect = std::clamp(
      camera.number("frameaspectratio", static_cast<float>(size.x) / static_cast<float>(size.y)), 0.01f, 100.0f);
  const std::vector<double> window = camera.numbers("screenwindow");
  if (window.size() == 4) {
    const Vec2 low(narrow(window[0]), narrow(window[2]));
    const Vec2 high(narrow(window[1]), narrow(window[3]));
    if (high.x > low.x && high.y > low.y) {
      const Screen screen{(high - low) / 2.0f, (high + low) / 2.0f};
      if (glm::length(screen.centre) > 1e-4f * glm::length(screen.half))
        warnings.add("the camera's screen window is not centred; a window of the same size about the centre is used");
      return screen;
    }
  }
  return {aspect > 1 ? Vec2(aspect, 1) : Vec2(1, 1 / aspect)};
}

void set_lens(const Parameters& p, Camera& camera) {
  camera.lens_radius = std::clamp(p.number("lensradius", 0), 0.0f, 1e9f);
  camera.focus_distance = std::clamp(p.number("focaldistance", 1e6f), 1e-6f, 1e9f);
}

/// Full angle of an image with that half height at distance 1, within limits.
float vertical_fov(float half_height) { return std::clamp(2 * std::atan(half_height), 1e-4f, glm::radians(179.0f)); }

/// `half_height`: of the screen window. With a lens, pbrt's rays start on the lens, at the camera's position, and pass
/// through the window at the focus distance (OrthographicCamera::GenerateRay()). This is a perspective camera.
void set_orthographic(const Parameters& p, float half_height, Camera& camera, Warnings& warnings) {
  const bool has_lens = p.number("lensradius", 0) > 0;
  p.number("focaldistance", 0);
  if (!has_lens) {
    camera.projection = Projection::orthographic;
    camera.half_height = std::clamp(half_height, 1e-6f, 1e9f);
    return;
  }
  warnings.add("an orthographic camera with a lens becomes a perspective one; pbrt renders it in perspective, too");
  set_lens(p, camera);
  camera.fov_y_rad = vertical_fov(half_height / camera.focus_distance);
}

/// Thin lens of a realistic camera: a lens of 50 mm before the film's diagonal.
void set_realistic(const Parameters& p, const Parameters& film, const IVec2& size, Camera& camera, Warnings& warnings) {
  constexpr float kFocalLength = 50;  // mm
  warnings.add("a realistic camera becomes a thin lens of 50 mm with its aperture and focus distance");
  const float diagonal = std::clamp(film.number("diagonal", 35), 0.1f, 1e4f);  // mm
  const float height = diagonal / glm::length(Vec2(size)) * static_cast<float>(size.y);
  camera.fov_y_rad = 2 * std::atan(height / 2 / kFocalLength);
  camera.lens_radius = std::clamp(p.number("aperturediameter", 1) / 2000, 0.0f, 1e3f);
  camera.focus_distance = std::clamp(p.number("focusdistance", 10), 1e-6f, 1e9f);
  p.string("lensfile");
  p.string("aperture");
}

Camera camera_of(const CameraEntity& source, const Parameters& film, Warnings& warnings) {
  const Parameters& p = source.parameters;
  const IVec2 size = film_size(film);
  Camera camera;
  camera.name = "camera";
  const Screen screen = screen_of(p, size, warnings);
  camera.aspect_ratio = std::clamp(static_cast<float>(size.x) / static_cast<float>(size.y), 0.01f, 100.0f);
  const float aspect = screen.half.x / screen.half.y;
  if (std::fabs(aspect / camera.aspect_ratio - 1) > 0.01f)
    warnings.add("pixels that are not square are not supported; the camera's vertical field of view counts");
  if (source.kind == "perspective") {
    const float fov = std::clamp(p.number("fov", 90), 0.01f, 179.0f);
    camera.fov_y_rad = vertical_fov(screen.half.y * std::tan(glm::radians(fov / 2)));
    set_lens(p, camera);
  } else if (source.kind == "orthographic") {
    set_orthographic(p, screen.half.y, camera, warnings);
  } else if (source.kind == "spherical") {
    camera.projection = Projection::panoramic;
    if (p.string("mapping", "equalarea") != "equirectangular")
      warnings.add("images of spherical cameras are equirectangular; pbrt would render equal areas");
  } else if (source.kind == "realistic") {
    set_realistic(p, film, size, camera, warnings);
  } else {
    fail(p.where(),
         fmt::format("there is no camera '{}'; use perspective, orthographic, spherical or realistic", source.kind));
  }
  for (const char* ignored : {"shutteropen", "shutterclose"}) p.number(ignored, 0);
  p.warn_of_unused(fmt::format("camera '{}'", source.kind), warnings);
  return camera;
}

/// Exposure in stops of pbrt's film sensor.
float exposure_of(const Description& d, Warnings& warnings) {
  const Parameters& film = d.film;
  if (const std::string sensor = film.string("sensor", "cie1931"); sensor != "cie1931")
    warnings.add(fmt::format("the film sensor '{}' is not supported; colours are those of the observer", sensor));
  if (film.number("whitebalance", 0) > 0) warnings.add("the white balance of the film is ignored");
  const float open = d.camera.parameters.number("shutteropen", 0);
  const float close = d.camera.parameters.number("shutterclose", 1);
  const float ratio = (close - open) * film.number("iso", 100) / 100;
  return ratio > 0 && is_finite(ratio) ? std::clamp(std::log2(ratio), -64.0f, 64.0f) : 0.0f;
}

/// The shutter's interval, if its middle is a time of the animation.
void add_shutter(const Description& d, nlohmann::json& settings) {
  constexpr float kLatest = 1e6f;
  const float open = d.camera.parameters.number("shutteropen", 0);
  const float close = d.camera.parameters.number("shutterclose", 1);
  const float middle = open + 0.5f * (close - open);
  if (!(close > open && close - open <= kLatest && middle >= 0 && middle <= kLatest)) return;
  settings["shutter"] = close - open;
  settings["scene-time"] = middle;
}

void add_settings(const Description& d, Scene& scene, Warnings& warnings) {
  const IVec2 size = film_size(d.film);
  nlohmann::json settings = {{"width", size.x}, {"height", size.y}};
  settings["max-bounces"] = std::clamp(d.integrator.integer("maxdepth", 5), 0, 1024);
  if (d.has_sampler) settings["spp"] = std::clamp(d.sampler.integer("pixelsamples", 16), 1, 1 << 30);
  if (const float exposure = exposure_of(d, warnings); exposure != 0) settings["exposure"] = exposure;
  if (!scene.animation.empty()) add_shutter(d, settings);
  scene.crop = crop_window(d.film, size);
  scene.settings_json = settings.dump();
}

}  // namespace

Mat4 from_relume_camera(const std::string& kind) {
  if (kind == "spherical") return Mat4(Vec4(0, 0, -1, 0), Vec4(0, 1, 0, 0), Vec4(1, 0, 0, 0), Vec4(0, 0, 0, 1));
  return Mat4(Vec4(1, 0, 0, 0), Vec4(0, 1, 0, 0), Vec4(0, 0, -1, 0), Vec4(0, 0, 0, 1));
}

Mat3 world_orientation(const Description& d) {
  const Matrix to_world = inverse_or_identity(d.camera.from_world.at[0]) * Matrix(from_relume_camera(d.camera.kind));
  Mat3 orientation(1);
  if (glm::determinant(glm::dmat3(to_world)) < 0) orientation[2].z = -1;
  const Vec3 up = d.camera.up ? Vec3(*d.camera.up) : Vec3(0, 1, 0);
  const float length = glm::length(up);
  constexpr float kAligned = 0.9f;
  Mat3 turn(1);  // about X or Z
  if (std::fabs(up.z) > kAligned * length) {
    const float s = up.z > 0 ? 1.0f : -1.0f;
    turn = Mat3(1, 0, 0, 0, 0, -s, 0, s, 0);
  } else if (std::fabs(up.x) > kAligned * length) {
    const float s = up.x > 0 ? 1.0f : -1.0f;
    turn = Mat3(0, s, 0, -s, 0, 0, 0, 0, 1);
  } else if (up.y < -kAligned * length) {
    turn = Mat3(-1, 0, 0, 0, -1, 0, 0, 0, 1);
  }
  return orientation * turn;
}

void animate(const Mat4& start, const Mat4& end, const std::array<double, 2>& times, Index node, Scene& scene,
             Warnings& warnings) {
  if (!(times[1] > times[0]) || !(std::fabs(times[0]) < 1e6) || !(std::fabs(times[1]) < 1e6)) return;
  if (!is_decomposable(start) || !is_decomposable(end))
    warnings.add("a moving transform shears; its nearest translation, rotation and scale are used");
  const Transform a = decompose(start);
  Transform b = decompose(end);
  if (glm::dot(a.rotation, b.rotation) < 0) b.rotation = -b.rotation;
  const auto add = [&](AnimatedProperty property, const Vec4& from, const Vec4& to) {
    AnimationChannel channel;
    channel.node = node;
    channel.property = property;
    channel.times = {static_cast<float>(times[0]), static_cast<float>(times[1])};
    channel.values = {from, to};
    if (from != to && channel.times[1] > channel.times[0]) scene.animation.push_back(std::move(channel));
  };
  const auto numbers = [](const Quaternion& q) { return Vec4(q.x, q.y, q.z, q.w); };
  add(AnimatedProperty::translation, Vec4(a.translation, 0), Vec4(b.translation, 0));
  add(AnimatedProperty::rotation, numbers(a.rotation), numbers(b.rotation));
  add(AnimatedProperty::scale, Vec4(a.scale, 0), Vec4(b.scale, 0));
  warnings.note("relume animates what moves; the shutter's interval becomes the settings shutter and scene-time");
}

void add_camera(const Description& d, const Mat3& orientation, Scene& scene, Warnings& warnings) {
  if (!d.has_camera) warnings.add("the file has no camera; pbrt's default one at the origin is used");
  const auto to_relume = [&](const Matrix& from_world) {
    return Mat4(orientation) * narrow(inverse_or_identity(from_world)) * from_relume_camera(d.camera.kind);
  };
  const Mat4 start = to_relume(d.camera.from_world.at[0]);
  Node node;
  node.name = "camera";
  node.camera = static_cast<Index>(scene.cameras.size());
  node.transform = decompose(start);
  node.transform.scale = Vec3(1);
  scene.cameras.push_back(camera_of(d.camera, d.film, warnings));
  const Index index = scene.add_node(std::move(node));
  if (d.camera.from_world.is_animated())
    animate(start, to_relume(d.camera.from_world.at[1]), d.camera.times, index, scene, warnings);
  add_settings(d, scene, warnings);
}

}  // namespace relume::pbrt

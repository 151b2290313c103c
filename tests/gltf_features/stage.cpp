#include "gltf_features/stage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "support/scenes.h"

namespace relume::support {
namespace {

/// Collects the names of all extensions below `value`.
void collect_extensions(const json& value, std::set<std::string>& names) {
  if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      if (key == "extensions") {
        for (const auto& extension : member.items()) names.insert(extension.key());
      }
    }
  }
  if (value.is_structured()) {
    for (const json& member : value) collect_extensions(member, names);
  }
}

/// Largest difference of a channel, and its pixel.
struct Difference {
  double value = 0;
  int x = 0;
  int y = 0;
};

Difference largest_difference(const Image& image, const std::function<Rgb(int x, int y)>& expected) {
  Difference largest;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double value = static_cast<double>(max_component(abs(image.at(x, y) - expected(x, y))));
      if (!(value <= largest.value)) largest = {value, x, y};
    }
  }
  return largest;
}

Difference largest_difference(const Image& a, const Image& b) {
  return largest_difference(a, [&](int x, int y) { return b.at(x, y); });
}

std::string text_of(const Rgb& c) {
  return "(" + std::to_string(c.r) + ", " + std::to_string(c.g) + ", " + std::to_string(c.b) + ")";
}

}  // namespace

Stage::Stage() {
  const int camera = file.add(
      "cameras",
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 16.0 / 9}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 100}}}});
  file.add_root({{"camera", camera}, {"translation", {0, 0, 5}}});
}

json Stage::square(const std::vector<float>& uv) {
  json attributes = {{"POSITION", file.floats(kCorners, 3)}};
  if (!uv.empty()) attributes["TEXCOORD_0"] = file.floats(uv, 2);
  return attributes;
}

int Stage::mesh(const json& attributes, const json& material) {
  const json primitive = {{"attributes", attributes},
                          {"indices", file.accessor(kTriangles, 1, 5123)},
                          {"material", file.add("materials", material)}};
  return file.add("meshes", {{"primitives", json::array({primitive})}});
}

int Stage::show(const json& attributes, const json& material, const json& node) {
  json root = node;
  root["mesh"] = mesh(attributes, material);
  return file.add_root(root);
}

json Stage::texture(int width, int height, const std::vector<uint8_t>& texels, const json& sampler) {
  json members = {{"magFilter", 9728}};
  members.update(sampler);
  const int view = file.add_view(testing::png(width, height, texels));
  const int image = file.add("images", {{"bufferView", view}, {"mimeType", "image/png"}});
  return {{"index", file.add("textures", {{"source", image}, {"sampler", file.add("samplers", members)}})}};
}

void Stage::light(const json& light, const json& node) {
  json& lights = file.doc["extensions"]["KHR_lights_punctual"]["lights"];
  lights.push_back(light);
  json root = node;
  root["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
  file.add_root(root);
}

void Stage::sun(float tilt) {
  light({{"type", "directional"}, {"intensity", 10}}, {{"rotation", rotation_json({0, 1, 0}, tilt)}});
}

void Stage::animate(int node, const char* path, const std::vector<float>& times, const std::vector<float>& values,
                    int components, const char* interpolation) {
  if (!file.doc.contains("animations"))
    file.add("animations", {{"samplers", json::array()}, {"channels", json::array()}});
  json& animation = file.doc["animations"][0];
  const json sampler = {
      {"input", file.floats(times, 1)}, {"output", file.floats(values, components)}, {"interpolation", interpolation}};
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
  animation["samplers"].push_back(sampler);
}

std::string Stage::text() {
  name_extensions(file.doc);
  return file.text();
}

Scene Stage::load(float environment) {
  Scene scene = testing::load_text(text());
  if (scene.environment.kind == EnvironmentKind::automatic) scene.environment.kind = EnvironmentKind::none;
  if (environment > 0) set_constant_environment(scene, Rgb(environment));
  return scene;
}

void name_extensions(json& doc) {
  std::set<std::string> names;
  collect_extensions(doc, names);
  if (!names.empty()) doc["extensionsUsed"] = names;
}

json rotation_json(const Vec3& axis, float angle) {
  const Vec3 v = axis * std::sin(0.5f * angle);
  return {v.x, v.y, v.z, std::cos(0.5f * angle)};
}

json unlit_json(const json& base_color_texture, const json& factor) {
  json material = {{"pbrMetallicRoughness", json::object()}, {"extensions", {{"KHR_materials_unlit", json::object()}}}};
  if (!base_color_texture.is_null()) material["pbrMetallicRoughness"]["baseColorTexture"] = base_color_texture;
  if (!factor.is_null()) material["pbrMetallicRoughness"]["baseColorFactor"] = factor;
  return material;
}

json matte_json(float albedo) {
  return {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {albedo, albedo, albedo, 1}}}},
          {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}};
}

json glowing_json(const json& radiance) {
  json material = matte_json(0);
  material["emissiveFactor"] = radiance;
  return material;
}

std::vector<uint8_t> colorful(int width, int height) {
  std::vector<uint8_t> texels;
  for (int i = 0; i < width * height; ++i) {
    const int x = i % width;
    const int y = i / width;
    const int channels[] = {30 + 200 * x / width, 250 - 200 * y / height, (x + y) % 2 * 150 + 20, 255};
    for (const int channel : channels) texels.push_back(static_cast<uint8_t>(channel));
  }
  return texels;
}

double linear_of(int code) {
  const double s = code / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

Image image(Scene scene, int size, int spp, int max_bounces) {
  RenderSettings settings = small_settings(size, size);
  settings.time_s = 0.5f;
  settings.path.max_bounces = max_bounces;
  settings.path.russian_roulette = false;  // its noise is too high for few samples
  return render(std::move(scene), settings, spp);
}

void expect_pixels(const Image& image, double tolerance, const std::function<Rgb(double x, double y)>& expected) {
  const auto at = [&](int x, int y) {
    return expected(2 * (x + 0.5) / image.width - 1, 1 - 2 * (y + 0.5) / image.height);
  };
  const Difference d = largest_difference(image, at);
  EXPECT_LE(d.value, tolerance) << "pixel (" << d.x << ", " << d.y << ") is " << text_of(image.at(d.x, d.y)) << ", not "
                                << text_of(at(d.x, d.y));
}

void expect_same(const Image& a, const Image& b, double tolerance) {
  const Difference d = largest_difference(a, b);
  EXPECT_LE(d.value, tolerance) << "pixel (" << d.x << ", " << d.y << ") is " << text_of(a.at(d.x, d.y)) << ", not "
                                << text_of(b.at(d.x, d.y));
}

void FeatureTest::check() const {
  const FeatureCase& c = GetParam();
  Scene scene = c.scene(Way::feature);
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
  const auto seen = [&](Scene shown) { return image(std::move(shown), 16, 4, c.max_bounces); };
  const Image expected = seen(c.scene(Way::plain));
  expect_same(seen(std::move(scene)), expected, c.tolerance);
  EXPECT_GT(largest_difference(seen(c.scene(Way::ignored)), expected).value, 0.02 + 2 * c.tolerance)
      << "the scene looks the same without the feature";
}

}  // namespace relume::support

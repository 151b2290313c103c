// Textures of Mitsuba scenes.
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "core/srgb.h"
#include "scene_io/testing/mitsuba_scene.h"

namespace relume {
namespace {

using testing::load_mitsuba_bsdf;
using testing::load_mitsuba_text;
using testing::mentions;
using testing::png;
using testing::SceneFolder;

std::string rgb(const std::string& name, const std::string& value) {
  return "<rgb name=\"" + name + "\" value=\"" + value + "\"/>";
}

/// Folder with "a.png" of two texels by two: black, white above grey, red.
struct Pictured : SceneFolder {
  Pictured() { write("a.png", png(2, 2, {0, 0, 0, 255, 255, 255, 255, 255, 128, 128, 128, 255, 255, 0, 0, 255})); }
};

std::string bitmap(const std::string& name, const std::string& more = "") {
  return "<texture type=\"bitmap\" name=\"" + name + "\"><string name=\"filename\" value=\"a.png\"/>" + more +
         "</texture>";
}

int byte_of(const Texture& t, size_t texel, size_t channel) {
  return std::to_integer<int>(t.texels.at(4 * texel + channel));
}

TEST(MitsubaTextures, Bitmaps) {
  const Pictured folder;
  const std::string raw =
      "<boolean name=\"raw\" value=\"true\"/><string name=\"wrap_mode\" value=\"mirror\"/><string "
      "name=\"filter_type\" value=\"nearest\"/>";
  const Scene scene =
      load_mitsuba_bsdf("<bsdf type=\"diffuse\">" + bitmap("reflectance", raw) + "</bsdf>", folder.path());
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.base_color, Rgb(1));
  const Texture& t = scene.textures.at(static_cast<size_t>(m.base_color_texture.texture));
  EXPECT_EQ(t.format, PixelFormat::rgba8_linear);
  EXPECT_EQ(t.wrap_u, WrapMode::mirror);
  EXPECT_EQ(t.filter, FilterMode::nearest);
  EXPECT_EQ(byte_of(t, 1, 0), 255);  // row 0 is at v = 0
  const Scene encoded = load_mitsuba_bsdf("<bsdf type=\"diffuse\">" + bitmap("reflectance") + "</bsdf>", folder.path());
  EXPECT_EQ(encoded.textures.at(0).format, PixelFormat::rgba8_srgb);
}

TEST(MitsubaTextures, ToUvKeepsItsMeaning) {
  const Pictured folder;
  const std::string to_uv =
      "<transform name=\"to_uv\"><scale x=\"3\" y=\"-2\"/><rotate z=\"1\" angle=\"30\"/><translate x=\"0.5\" "
      "y=\"0.25\"/></transform>";
  const TextureRef ref =
      load_mitsuba_bsdf("<bsdf type=\"diffuse\">" + bitmap("reflectance", to_uv) + "</bsdf>", folder.path())
          .materials[0]
          .base_color_texture;
  const double c = std::cos(kPi / 6);
  const double s = std::sin(kPi / 6);
  for (const Vec2 uv : {Vec2(0, 0), Vec2(1, 0), Vec2(0.3f, 0.7f)}) {
    // uv' = offset + R (scale ⊙ uv) with R = (cos sin; −sin cos), as TextureRef states.
    const Vec2 scaled = ref.scale * uv;
    const float cr = std::cos(ref.rotation_rad), sr = std::sin(ref.rotation_rad);
    const Vec2 actual = ref.offset + Vec2(cr * scaled.x + sr * scaled.y, -sr * scaled.x + cr * scaled.y);
    EXPECT_NEAR(actual.x, c * 3 * uv.x + s * 2 * uv.y + 0.5, 1e-5);
    EXPECT_NEAR(actual.y, s * 3 * uv.x - c * 2 * uv.y + 0.25, 1e-5);
  }
}

TEST(MitsubaTextures, OfNonlinearPlasticAreAlbedosBelowItsCoat) {
  const Pictured folder;
  const Scene scene = load_mitsuba_bsdf(
      "<bsdf type=\"plastic\">" + bitmap("diffuse_reflectance") + "<boolean name=\"nonlinear\" value=\"true\"/></bsdf>",
      folder.path());
  const Texture& t = scene.textures.at(0);
  EXPECT_EQ(t.file, nullptr);
  EXPECT_EQ(byte_of(t, 0, 0), 0);
  EXPECT_EQ(byte_of(t, 1, 0), 255);
  // 128 is 0.2158605; 0.2158605 · 0.4100080 / (1 − 0.2158605 · 0.5899920) = 0.1014230, which is 90 of 255.
  EXPECT_EQ(byte_of(t, 2, 0), 90);
}

TEST(MitsubaTextures, TheWhiteOfALampMayHoldATexture) {
  const Pictured folder;
  const Scene scene =
      load_mitsuba_text("<shape type=\"rectangle\"><emitter type=\"area\"><spectrum type=\"d65\" name=\"radiance\">" +
                            bitmap("any") + "<float name=\"scale\" value=\"3\"/></spectrum></emitter></shape>",
                        folder.path());
  EXPECT_EQ(scene.materials[0].emission, Rgb(3));
  EXPECT_TRUE(scene.materials[0].emission_texture.used());
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(MitsubaTextures, ScaledTextures) {
  const Pictured folder;
  const auto scaled = [](const std::string& name, const std::string& scale) {
    return "<texture type=\"scale\" name=\"" + name + "\"><float name=\"scale\" value=\"" + scale + "\"/>" +
           bitmap("any", "<boolean name=\"raw\" value=\"true\"/>") + "</texture>";
  };
  const Scene diffuse =
      load_mitsuba_bsdf("<bsdf type=\"diffuse\">" + scaled("reflectance", "0.5") + "</bsdf>", folder.path());
  EXPECT_EQ(byte_of(diffuse.textures.at(0), 1, 0), 128);
  EXPECT_EQ(byte_of(diffuse.textures.at(0), 2, 0), 64);
  EXPECT_TRUE(diffuse.warnings.empty());
  const auto bump_scale = [&](const std::string& scale) {
    const std::string bsdf = "<bsdf type=\"bumpmap\">" + scaled("bumps", scale) + "<bsdf type=\"diffuse\"/></bsdf>";
    return load_mitsuba_bsdf(bsdf, folder.path()).materials.at(0).normal_scale;
  };
  EXPECT_FLOAT_EQ(bump_scale("1.5") / bump_scale("1.25"), 1.2f);  // both between two powers of two
}

TEST(MitsubaTextures, Checkerboards) {
  const Scene scene = load_mitsuba_bsdf("<bsdf type=\"diffuse\"><texture type=\"checkerboard\" name=\"reflectance\">" +
                                        rgb("color0", "0.75") + rgb("color1", "0.25") + "</texture></bsdf>");
  const Texture& t = scene.textures.at(0);
  float texels[16];
  ASSERT_EQ(t.texels.size(), sizeof texels);
  std::memcpy(texels, t.texels.data(), sizeof texels);
  // color0 where both coordinates are below one half, or both above.
  EXPECT_EQ(texels[0], 0.75f);
  EXPECT_EQ(texels[4], 0.25f);
  EXPECT_EQ(texels[8], 0.25f);
  EXPECT_EQ(texels[12], 0.75f);
  EXPECT_EQ(t.filter, FilterMode::nearest);
}

TEST(MitsubaTextures, ImagesAreCombinedIntoChannels) {
  const Pictured folder;
  const std::string raw = "<boolean name=\"raw\" value=\"true\"/>";
  const Scene rough =
      load_mitsuba_bsdf("<bsdf type=\"roughconductor\">" + bitmap("alpha", raw) + "</bsdf>", folder.path());
  const Texture& g = rough.textures.at(static_cast<size_t>(rough.materials[0].metallic_roughness_texture.texture));
  EXPECT_EQ(rough.materials[0].roughness, 1);
  EXPECT_NEAR(byte_of(g, 2, 1), 255 * std::sqrt(128 / 255.0), 1);
  const Scene brushed = load_mitsuba_bsdf("<bsdf type=\"roughconductor\">" + bitmap("alpha_u", raw) +
                                              "<texture type=\"checkerboard\" name=\"alpha_v\">" +
                                              rgb("color0", "0.04") + rgb("color1", "0.36") + "</texture></bsdf>",
                                          folder.path());
  const Material& m = brushed.materials[0];
  EXPECT_EQ(m.anisotropy, 1);
  const Texture& narrow = brushed.textures.at(static_cast<size_t>(m.metallic_roughness_texture.texture));
  const Texture& strength = brushed.textures.at(static_cast<size_t>(m.anisotropy_texture.texture));
  // Texel 1: white along u, 0.36 along v. Texel 2: 128 / 255 along u, 0.36 along v.
  EXPECT_NEAR(byte_of(narrow, 1, 1), 0.6 * 255, 1);
  EXPECT_EQ(byte_of(strength, 1, 2), 255);
  EXPECT_NEAR(byte_of(strength, 2, 2), 255 * std::sqrt((128 / 255.0 - 0.36) / 0.64), 1);
  EXPECT_EQ(byte_of(strength, 2, 0), 255);
  EXPECT_EQ(byte_of(strength, 0, 1), 255);  // texel 0: 0 along u, 0.04 along v
  const Scene both = load_mitsuba_bsdf(
      "<bsdf type=\"principled\">" + bitmap("roughness", raw) + bitmap("metallic", raw) + "</bsdf>", folder.path());
  const Texture& gb = both.textures.at(static_cast<size_t>(both.materials[0].metallic_roughness_texture.texture));
  EXPECT_EQ(byte_of(gb, 2, 1), 128);
  EXPECT_EQ(byte_of(gb, 3, 2), std::lround(0.2126 * 255));  // luminance of red
  const Scene mask = load_mitsuba_bsdf("<bsdf type=\"mask\">" + bitmap("opacity", raw) + "<bsdf type=\"diffuse\">" +
                                           bitmap("reflectance") + "</bsdf></bsdf>",
                                       folder.path());
  const Texture& rgba = mask.textures.at(static_cast<size_t>(mask.materials[0].base_color_texture.texture));
  EXPECT_EQ(byte_of(rgba, 3, 0), 255);
  EXPECT_EQ(byte_of(rgba, 3, 3), std::lround(0.2126 * 255));
  EXPECT_EQ(byte_of(rgba, 2, 0), 128);
}

TEST(MitsubaTextures, PartsOfBlendsHaveTheirOwnBumps) {
  const Pictured folder;
  const auto load = [&](const std::string& scale) {
    return load_mitsuba_text("<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"" + scale +
                                 "\"/></transform><bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.5\"/>"
                                 "<bsdf type=\"bumpmap\">" +
                                 bitmap("") +
                                 "<bsdf type=\"diffuse\"/></bsdf><bsdf type=\"conductor\"/></bsdf></shape>",
                             folder.path());
  };
  const Scene scene = load("1");
  ASSERT_EQ(scene.materials.size(), 3u);
  EXPECT_FALSE(scene.materials[0].normal_texture.used());
  EXPECT_TRUE(scene.materials[1].normal_texture.used());
  EXPECT_FALSE(scene.materials[2].normal_texture.used());
  const float flatter = load("1.5").materials[1].normal_scale;  // the same heights on a larger shape
  EXPECT_NEAR(flatter, scene.materials[1].normal_scale * 2 / 1.5f, 0.01f);
}

TEST(MitsubaTextures, BlendsFollowTheirWeight) {
  const Pictured folder;
  const Scene scene = load_mitsuba_bsdf(
      "<bsdf type=\"blendbsdf\">" + bitmap("weight", "<boolean name=\"raw\" value=\"true\"/>") +
          "<bsdf type=\"diffuse\">" + rgb("reflectance", "0.2") + "</bsdf><bsdf type=\"roughconductor\">" +
          "<float name=\"alpha\" value=\"0.04\"/>" + "</bsdf></bsdf>",
      folder.path());
  const Material& m = scene.materials[0];
  EXPECT_FLOAT_EQ(m.mix_share, 1);
  const Texture& weight = scene.textures.at(static_cast<size_t>(m.mix_texture.texture));
  EXPECT_EQ(byte_of(weight, 0, 0), 0);
  EXPECT_EQ(byte_of(weight, 2, 0), 128);
  const Texture& color = scene.textures.at(static_cast<size_t>(m.base_color_texture.texture));
  const Texture& surface = scene.textures.at(static_cast<size_t>(m.metallic_roughness_texture.texture));
  EXPECT_EQ(m.base_color, Rgb(1));
  // Texel 0: the first. Texel 1: the second. Texel 2: between them, at 128 / 255.
  EXPECT_EQ(byte_of(color, 0, 0), std::lround(255 * srgb_from_linear(0.2f)));
  EXPECT_EQ(byte_of(color, 1, 0), 255);
  EXPECT_EQ(byte_of(surface, 0, 2), 0);
  EXPECT_EQ(byte_of(surface, 1, 2), 255);
  EXPECT_EQ(byte_of(surface, 2, 2), 128);
  EXPECT_EQ(byte_of(surface, 0, 1), 255);
  EXPECT_EQ(byte_of(surface, 1, 1), 51);  // √0.04
}

TEST(MitsubaTextures, TheMeanReplacesTexturesWithoutEquivalent) {
  const Pictured folder;
  const Scene scene = load_mitsuba_bsdf(
      "<bsdf type=\"principled\">" + bitmap("clearcoat", "<boolean name=\"raw\" value=\"true\"/>") + "</bsdf>",
      folder.path());
  EXPECT_NEAR(scene.materials[0].clearcoat, (0 + 1 + 128 / 255.0 + 0.2126) / 4 / 4, 1e-4);
  EXPECT_TRUE(mentions(scene.warnings, "'clearcoat'; its mean replaces it"));
}

TEST(MitsubaTextures, MissingImagesAreWhite) {
  const Scene scene = load_mitsuba_bsdf("<bsdf type=\"diffuse\">" + bitmap("reflectance") + "</bsdf>");
  EXPECT_EQ(scene.textures.at(0).width, 1);
  EXPECT_TRUE(mentions(scene.warnings, "a.png"));
}

TEST(MitsubaTextures, NormalMapsUseMitsubasFrame) {
  const Pictured folder;
  const Scene scene = load_mitsuba_text("<shape type=\"rectangle\"><bsdf type=\"normalmap\">" +
                                            bitmap("normalmap", "<boolean name=\"raw\" value=\"true\"/>") +
                                            "<bsdf type=\"diffuse\"/></bsdf></shape>",
                                        folder.path());
  EXPECT_TRUE(scene.materials[0].normal_texture.used());
  // Y of the normal map is n × ∂p/∂u: +Y of the rectangle.
  const Vec4 tangent = scene.meshes[0].tangents.at(0);
  EXPECT_EQ(glm::cross(scene.meshes[0].normals[0], Vec3(tangent)) * tangent.w, Vec3(0, 1, 0));
}

TEST(MitsubaTextures, BumpsTiltNormalsByTheirSlope) {
  const SceneFolder folder;
  // A ramp of 1/255 per texel along u, 8 texels wide.
  std::vector<uint8_t> texels;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x)
      texels.insert(texels.end(),
                    {static_cast<uint8_t>(100 + x), static_cast<uint8_t>(100 + x), static_cast<uint8_t>(100 + x), 255});
  }
  folder.write("a.png", png(8, 8, texels));
  const Scene scene = load_mitsuba_text(
      "<shape type=\"rectangle\"><transform name=\"to_world\"><scale x=\"3\"/></transform><bsdf "
      "type=\"bumpmap\"><texture type=\"bitmap\">"
      "<string name=\"filename\" value=\"a.png\"/><boolean name=\"raw\" value=\"true\"/></texture><float "
      "name=\"scale\" value=\"30\"/>"
      "<bsdf type=\"diffuse\"/></bsdf></shape>",
      folder.path());
  const Texture& t = scene.textures.at(static_cast<size_t>(scene.materials[0].normal_texture.texture));
  ASSERT_EQ(t.format, PixelFormat::rgba32_float);
  Vec4 texel;
  std::memcpy(&texel, &t.texels[(8 * 4 + 4) * sizeof(Vec4)], sizeof texel);
  const Vec3 normal = Vec3(texel) * 2.0f - Vec3(1);
  // ∂h/∂u = 8 / 255 per unit of u, which is 6 m long.
  EXPECT_NEAR(scene.materials[0].normal_scale * normal.x / normal.z, -30 * 8 / 255.0 / 6, 1e-4);
  EXPECT_NEAR(normal.y, 0, 1e-6f);
}

TEST(MitsubaTextures, ShapesOfSimilarSizesShareBumps) {
  const SceneFolder folder;
  folder.write("a.png", png(2, 2, std::vector<uint8_t>(16, 100)));
  std::string text =
      "<bsdf type=\"bumpmap\" id=\"b\"><texture type=\"bitmap\"><string name=\"filename\" value=\"a.png\"/></texture>"
      "<bsdf type=\"diffuse\"/></bsdf>";
  for (const char* scale : {"1.1", "1.3", "1.9", "2.1"})
    text += "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"" + std::string(scale) +
            "\"/></transform><ref id=\"b\"/></shape>";
  const Scene scene = load_mitsuba_text(text, folder.path());
  ASSERT_EQ(scene.materials.size(), 4u);
  EXPECT_EQ(scene.textures.size(), 2u);  // slopes of 0.25 to 0.5, and below 0.25
  EXPECT_FLOAT_EQ(scene.materials[0].normal_scale / scene.materials[1].normal_scale, 1.3f / 1.1f);
}

TEST(MitsubaTextures, OneImageIsReadOnce) {
  const SceneFolder folder;
  Bytes image = png(2, 2, std::vector<uint8_t>(16, 100));
  image.resize(size_t{1} << 24);  // zeros after the end of the image
  folder.write("a.png", image);
  std::string text;
  for (int i = 0; i < 300; ++i) {
    const std::string colour = std::to_string(static_cast<float>(i) / 300);
    text += "<shape type=\"rectangle\"><bsdf type=\"blendbsdf\">" + bitmap("weight") + "<bsdf type=\"diffuse\">" +
            rgb("reflectance", colour) + "</bsdf><bsdf type=\"conductor\"/></bsdf></shape>";
  }
  const auto largest_KiB = [] {
    rusage self{};
    getrusage(RUSAGE_SELF, &self);
    return self.ru_maxrss;
  };
  const long before = largest_KiB();
  // Of all mixtures: the weight, and the approximating roughness and metalness.
  EXPECT_EQ(load_mitsuba_text(text, folder.path()).textures.size(), 302u);
  EXPECT_LT(largest_KiB() - before, 1 << 20);  // 600 copies are 9.4 GiB
}

TEST(MitsubaTextures, VertexColours) {
  const SceneFolder folder;
  folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "red\nproperty float green\nproperty float blue\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n0 0 0 0.5 0 0\n1 0 0 1 0 0\n0 1 0 0 1 0\n3 0 1 2\n");
  const auto load = [&](const std::string& bsdf) {
    return load_mitsuba_text("<shape type=\"ply\"><string name=\"filename\" value=\"a.ply\"/>" + bsdf + "</shape>",
                             folder.path());
  };
  const Scene colored = load(
      "<bsdf type=\"diffuse\"><texture type=\"mesh_attribute\" name=\"reflectance\"><string name=\"name\" "
      "value=\"vertex_color\"/></texture></bsdf>");
  EXPECT_EQ(colored.meshes[0].colors.at(0), Vec4(0.5f, 0, 0, 1));
  EXPECT_EQ(colored.materials[0].base_color, Rgb(1));
  EXPECT_TRUE(load("").meshes[0].colors.empty());
}

}  // namespace
}  // namespace relume

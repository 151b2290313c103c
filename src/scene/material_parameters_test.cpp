#include "scene/material_parameters.h"

#include <fstream>
#include <iterator>
#include <set>

#include <gtest/gtest.h>

#include "scene/scene_hash.h"

namespace relume {
namespace {

void change(float& value) { value = value == 0.5f ? 0.25f : 0.5f; }
void change(Rgb& value) { value = Rgb(0.3f); }
void change(bool& value) { value = !value; }
void change(TextureRef& value) { value.texture = 7; }
template <typename T>
requires std::is_enum_v<T>
void change(T& value) { value = static_cast<T>(static_cast<int>(value) + 1); }

uint64_t hash_of(const Material& material) {
  Scene scene;
  scene.materials.push_back(material);
  return scene_hash(scene);
}

/// Size of Material without its name and padding: the sum of the described members.
TEST(MaterialParameters, CoverEveryMember) {
  const Material material;
  size_t bytes = 0;
  for_each_parameter(material, [&](const MaterialParameter&, const auto& value) { bytes += sizeof value; });
  EXPECT_LE(sizeof(Material) - sizeof(std::string) - bytes, 16u) << "describe the new member in the table";
}

TEST(MaterialParameters, EachCountsInTheHash) {
  std::set<uint64_t> hashes = {hash_of(Material{})};
  for (size_t i = 0; i < material_parameters().size(); ++i) {
    Material material;
    size_t k = 0;
    for_each_parameter(material, [&](const MaterialParameter& p, auto& value) {
      if (k++ != i) return;
      change(value);
      EXPECT_TRUE(hashes.insert(hash_of(material)).second) << p.name;
    });
  }
}

TEST(MaterialParameters, KernelsGetThemWithinTheirRange) {
  Material material;
  material.metallic = 2;
  material.ior = 0.5f;
  material.clearcoat_roughness = -1;
  material.alpha = 3;
  const MaterialData data = material_data(material);
  EXPECT_EQ(data.metallic, 1);
  EXPECT_EQ(data.ior, 1);
  EXPECT_EQ(data.clearcoat_roughness, 0);
  EXPECT_EQ(data.alpha, 3);
  EXPECT_FALSE(data.uses_uv);
  material.clearcoat_texture.texture = 2;
  EXPECT_TRUE(material_data(material).uses_uv);
  EXPECT_EQ(material_data(material).clearcoat_texture.texture, 2);
}

TEST(MaterialParameters, DispersionNeedsAMediumThatRefracts) {
  Material glass;
  glass.transmission = 1;
  glass.thickness = 1;
  glass.dispersion = 0.4f;
  EXPECT_EQ(material_data(glass).dispersion, 0.4f);
  Material changed = glass;
  changed.thickness = 0;
  EXPECT_EQ(material_data(changed).dispersion, 0.0f);
  changed = glass;
  changed.transmission = 0;
  changed.diffuse_transmission = 1;
  EXPECT_EQ(material_data(changed).dispersion, 0.0f);
  changed = glass;
  changed.ior = 1;
  EXPECT_EQ(material_data(changed).dispersion, 0.0f);
  changed = glass;
  changed.dispersion = -1;
  EXPECT_EQ(material_data(changed).dispersion, 0.0f);
  changed.dispersion = 1e30f;
  EXPECT_EQ(material_data(changed).dispersion, 20.0f);
}

TEST(MaterialParameters, TheReferencePageIsUpToDate) {
  std::ifstream stream(std::filesystem::path(RELUME_SOURCE_DIR) / "docs" / "material-parameters.md");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  EXPECT_EQ(text, material_parameters_reference())
      << "regenerate: relume scenes --materials > docs/material-parameters.md";
}

}  // namespace
}  // namespace relume

#include "scene/animated_parameters.h"

#include <gtest/gtest.h>

#include "scene/compiled_scene.h"
#include "scene/material_parameters.h"
#include "scene/testing/plate.h"

namespace relume {
namespace {

using testing::plate;
using testing::problem_of;

ParameterChannel channel(AnimatedPart part, const std::string& parameter, const Vec4& first, const Vec4& last) {
  ParameterChannel c;
  c.part = part;
  c.index = 0;
  c.parameter = parameter;
  c.times = {0, 1};
  c.values = {first, last};
  return c;
}

CompileOptions small(float time_s = 0) { return {.time_s = time_s, .width = 4, .height = 4}; }

TEST(AnimatedParameters, AreFoundByName) {
  Material material;
  for (const MaterialParameter& p : material_parameters()) {
    const bool is_number =
        std::holds_alternative<float Material::*>(p.member) || std::holds_alternative<Rgb Material::*>(p.member);
    EXPECT_TRUE(!is_number || !std::holds_alternative<std::monostate>(find_parameter(material, p.key))) << p.key;
  }
  EXPECT_EQ(std::get<float*>(find_parameter(material, "roughness")), &material.roughness);
  EXPECT_EQ(std::get<Rgb*>(find_parameter(material, "base_color")), &material.base_color);
  EXPECT_EQ(std::get<Vec2*>(find_parameter(material, "base_color_texture.offset")),
            &material.base_color_texture.offset);
  EXPECT_EQ(std::get<float*>(find_parameter(material, "normal_texture.rotation")),
            &material.normal_texture.rotation_rad);
  for (const char* name : {"", "colour", "double_sided", "roughness_texture.size", "roughness."})
    EXPECT_TRUE(std::holds_alternative<std::monostate>(find_parameter(material, name))) << name;
}

TEST(AnimatedParameters, StayWithinTheirRange) {
  Material material;
  apply(channel(AnimatedPart::material, "roughness", Vec4(-3), Vec4(7)), 0, material);
  EXPECT_EQ(material.roughness, 0);
  apply(channel(AnimatedPart::material, "roughness", Vec4(-3), Vec4(7)), 1, material);
  EXPECT_EQ(material.roughness, 1);
  Camera camera;
  apply(channel(AnimatedPart::camera, "fov_y", Vec4(-1), Vec4(9)), 1, camera);
  EXPECT_LT(camera.fov_y_rad, kPi);
  PunctualLight light{.name = "spot", .type = PunctualType::spot};
  light.outer_cone_rad = 0.3f;
  apply(channel(AnimatedPart::light, "inner_cone", Vec4(0), Vec4(1)), 1, light);
  EXPECT_EQ(light.inner_cone_rad, 0.3f);
}

TEST(AnimatedParameters, MaterialsFollowTheTime) {
  Scene scene = plate();
  scene.parameter_animation = {channel(AnimatedPart::material, "base_color", Vec4(0, 0, 0, 0), Vec4(1, 0.5f, 0.25f, 0)),
                               channel(AnimatedPart::material, "emission", Vec4(0), Vec4(4, 4, 4, 0))};
  CompiledScene compiled(scene, small());
  EXPECT_EQ(compiled.view().materials[0].base_color, Rgb(0));
  EXPECT_EQ(compiled.set_time(0), Change::none);
  const Change change = compiled.set_time(0.5f);
  EXPECT_NE(change & Change::materials, Change::none);
  EXPECT_NE(change & Change::lights, Change::none);
  EXPECT_EQ(compiled.view().materials[0].base_color, Rgb(0.5f, 0.25f, 0.125f));
  EXPECT_EQ(compiled.view().lights.lights[0].triangle.radiance, Rgb(2));
  const CompiledScene begun_there(scene, small(0.5f));
  EXPECT_EQ(begun_there.view().materials[0].base_color, Rgb(0.5f, 0.25f, 0.125f));
  Material fixed = scene.materials[0];
  fixed.base_color = Rgb(0.1f);
  compiled.set_material(0, fixed);
  compiled.set_time(1);
  EXPECT_EQ(compiled.view().materials[0].base_color, Rgb(0.1f));
}

TEST(AnimatedParameters, LightsAndCamerasFollowTheTime) {
  Scene scene = plate();
  scene.lights.emplace_back();
  Node lamp;
  lamp.light = 0;
  scene.add_node(lamp);
  scene.parameter_animation = {channel(AnimatedPart::light, "intensity", Vec4(0), Vec4(2, 4, 6, 0)),
                               channel(AnimatedPart::camera, "fov_y", Vec4(0.5f), Vec4(1.5f))};
  CompiledScene compiled(scene, small());
  compiled.end_frame();
  const Change change = compiled.set_time(0.5f);
  EXPECT_NE(change & Change::lights, Change::none);
  EXPECT_NE(change & Change::camera, Change::none);
  EXPECT_EQ(compiled.view().lights.lights[0].point.intensity, Rgb(1, 2, 3));
  EXPECT_FLOAT_EQ(compiled.view().camera.half_extent.y, std::tan(0.5f));
}

TEST(AnimatedParameters, ChannelsAreChecked) {
  const auto problem = [](const ParameterChannel& c) {
    return problem_of([&] {
      Scene scene = plate();
      scene.parameter_animation = {c};
      validate(scene, "plate");
    });
  };
  EXPECT_EQ(problem(channel(AnimatedPart::material, "roughness", Vec4(0), Vec4(1))), "");
  EXPECT_NE(problem(channel(AnimatedPart::material, "hue", Vec4(0), Vec4(1))).find("drives 'hue' of part 0"),
            std::string::npos);
  EXPECT_NE(problem(channel(AnimatedPart::light, "intensity", Vec4(0), Vec4(1))).find("does not exist"),
            std::string::npos);
  ParameterChannel backwards = channel(AnimatedPart::material, "roughness", Vec4(0), Vec4(1));
  backwards.times = {1, 0};
  EXPECT_NE(problem(backwards).find("times that do not increase"), std::string::npos);
}

}  // namespace
}  // namespace relume

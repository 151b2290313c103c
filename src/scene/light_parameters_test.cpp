#include "scene/light_parameters.h"

#include <set>

#include <gtest/gtest.h>

#include "relume/error.h"
#include "scene/scene_hash.h"

namespace relume {
namespace {

uint64_t hash_of(const PunctualLight& light) {
  Scene scene;
  scene.lights.push_back(light);
  return scene_hash(scene);
}

TEST(LightParameters, TypesAreOrdered) {
  for (size_t i = 0; i < light_types().size(); ++i) {
    EXPECT_EQ(static_cast<size_t>(light_types()[i].type), i);
    PunctualLight light;
    light.type = light_types()[i].type;
    EXPECT_EQ(&type_of(light), &light_types()[i]);
  }
  EXPECT_EQ(light_type_names(), (std::vector<std::string_view>{"point", "spot", "directional"}));
}

TEST(LightParameters, EachCountsInTheHashAndIsChecked) {
  std::set<uint64_t> hashes = {hash_of({})};
  for (const LightParameter& p : light_parameters()) {
    PunctualLight light;
    EXPECT_NO_THROW(validate(light, "a"));
    light.*p.member = 0.5f * upper_limit(p, light) + 0.01f;
    EXPECT_NO_THROW(validate(light, "a")) << p.name;
    EXPECT_TRUE(hashes.insert(hash_of(light)).second) << p.name;
    light.*p.member = -0.1f;
    EXPECT_THROW(validate(light, "a"), Error) << p.name;
    light.*p.member = p.most_rad + 0.1f;
    EXPECT_THROW(validate(light, "a"), Error) << p.name;
  }
}

TEST(LightParameters, TheInnerConeIsLimitedByTheOuter) {
  PunctualLight light;
  light.outer_cone_rad = 0.2f;
  light.inner_cone_rad = 0.3f;
  try {
    validate(light, "a");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "a: light '': inner cone is 0.3 radians; give it a value between 0 and 0.2");
  }
}

}  // namespace
}  // namespace relume

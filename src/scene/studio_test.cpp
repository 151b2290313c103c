#include "scene/studio.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lights/environment.h"
#include "scene/light_builder.h"

namespace relume {
namespace {

/// The compiled studio, rotated by an angle.
class Studio {
 public:
  explicit Studio(float rotation_rad = 0) {
    Environment environment;
    environment.kind = EnvironmentKind::studio;
    environment.rotation_rad = rotation_rad;
    builder_.set_environment(environment);
  }
  float radiance(const Vec3& w) const { return luminance(builder_.view().environment.radiance(glm::normalize(w))); }
  /// Irradiance of a plane facing `n`.
  float irradiance(const Vec3& n) const {
    float sum = 0;
    constexpr int kCount = 64;
    for (int i = 0; i < kCount; ++i) {
      for (int k = 0; k < kCount; ++k) {
        const Vec2 u((static_cast<float>(i) + 0.5f) / kCount, (static_cast<float>(k) + 0.5f) / kCount);
        const Vec3 w = sphere_from_square(u);
        sum += std::max(0.0f, glm::dot(w, n)) * radiance(w);
      }
    }
    return sum * 4 * kPi / (kCount * kCount);
  }

 private:
  LightBuilder builder_;
};

TEST(Studio, IsNeutralAndDarkerThanItsKeyLight) {
  const EnvironmentMap map = make_studio();
  float brightest = 0;
  size_t dim = 0;
  for (const Rgb& texel : map.texels) {
    EXPECT_EQ(texel.r, texel.g);
    EXPECT_EQ(texel.g, texel.b);
    EXPECT_GT(texel.r, 0.05f);
    brightest = std::max(brightest, texel.r);
    dim += texel.r < 0.6f ? 1 : 0;
  }
  EXPECT_GT(brightest, 8.0f);
  EXPECT_GT(static_cast<double>(dim) / static_cast<double>(map.texels.size()), 0.7) << "mostly backdrop";
}

TEST(Studio, LightsTheSideThatTheCameraSeesFromTheLeft) {
  const Studio studio;
  EXPECT_GT(studio.irradiance(glm::normalize(Vec3(-1, 1, 1))), 1.2f * studio.irradiance(glm::normalize(Vec3(1, 1, 1))));
  EXPECT_GT(studio.irradiance(Vec3(0, 0, 1)), studio.irradiance(Vec3(0, -1, 0)));
  EXPECT_GT(studio.irradiance(Vec3(0, -1, 0)), 0.2f) << "no side is black";
}

TEST(Studio, TurnsWithTheCamera) {
  for (const Vec3& forward : {Vec3(0, 0, -1), Vec3(-1, -0.3f, 0.2f), Vec3(0.5f, 0.4f, 0.8f)}) {
    const Studio studio(studio_rotation_rad(forward));
    const Vec3 behind = -glm::normalize(Vec3(forward.x, 0, forward.z));
    const Vec3 left = glm::cross(Vec3(0, 1, 0), -behind);
    const Vec3 key = behind + 0.9f * left + Vec3(0, 1.2f, 0);
    EXPECT_GT(studio.radiance(key), 8.0f) << forward.x << ' ' << forward.z;
  }
  EXPECT_EQ(studio_rotation_rad({0, -1, 0}), 0.0f);
}

}  // namespace
}  // namespace relume

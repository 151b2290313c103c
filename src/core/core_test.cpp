#include <gtest/gtest.h>

#include <string_view>
#include <thread>
#include <unordered_set>
#include <vector>

#include "core/euler.h"
#include "core/fixed_point.h"
#include "core/fnv1a.h"
#include "core/frame.h"
#include "core/hash.h"
#include "core/memory.h"
#include "core/octahedral.h"
#include "core/ray.h"

namespace relume {
namespace {

/// Directions in all octants, including the axes and diagonals, where frames and maps have their seams.
std::vector<Vec3> directions() {
  std::vector<Vec3> result;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) result.push_back(glm::normalize(Vec3(x, y, z)));
      }
    }
  }
  for (uint32_t i = 0; i < 10000; ++i) {
    const float z = 2.0f * to_unit_float(hash(i, 0u)) - 1.0f;
    const float phi = 2.0f * kPi * to_unit_float(hash(i, 1u));
    result.push_back(Vec3(std::cos(phi), std::sin(phi), 0.0f) * safe_sqrt(1.0f - sqr(z)) + Vec3(0, 0, z));
  }
  return result;
}

/// Largest distance between the components of two vectors.
float distance(const Vec3& a, const Vec3& b) { return max_component(abs(a - b)); }

TEST(Vec, ClampsAndChecks) {
  EXPECT_EQ(saturate(-1.0f), 0.0f);
  EXPECT_EQ(saturate(2.0f), 1.0f);
  EXPECT_EQ(safe_sqrt(-1e-9f), 0.0f);
  EXPECT_TRUE(is_finite(Vec3(3.4e38f, 0, -3.4e38f)));
  EXPECT_FALSE(is_finite(Vec3(0, kInfinity, 0)));
  EXPECT_FALSE(is_finite(std::nanf("")));
  EXPECT_LT(to_unit_float(0xffffffffu), 1.0f);
  EXPECT_LT(kOneMinusEpsilon, 1.0f);
}

TEST(Vec, TransformsPointsWithAndVectorsWithoutTranslation) {
  Mat4 m(2.0f);
  m[3] = Vec4(1, 2, 3, 1);
  EXPECT_EQ(transform_point(m, {1, 1, 1}), Vec3(3, 4, 5));
  EXPECT_EQ(transform_vector(m, {1, 1, 1}), Vec3(2, 2, 2));
}

TEST(Frame, IsOrthonormalAndRightHanded) {
  for (const Vec3& n : directions()) {
    const Frame f = make_frame(n);
    // Allows for a few roundings of numbers up to one.
    constexpr float kTolerance = 1e-6f;
    EXPECT_NEAR(glm::dot(f.t, f.b), 0.0f, kTolerance);
    EXPECT_NEAR(glm::dot(f.t, f.n), 0.0f, kTolerance);
    EXPECT_NEAR(length_squared(f.t), 1.0f, kTolerance);
    EXPECT_LT(distance(glm::cross(f.t, f.b), n), kTolerance);
    EXPECT_LT(distance(f.to_world(f.to_local({0.6f, 0.0f, -0.8f})), {0.6f, 0.0f, -0.8f}), kTolerance);
  }
}

TEST(Hash, IsBijectiveOnASample) {
  std::unordered_set<uint32_t> seen;
  for (uint32_t i = 0; i < 100000; ++i) seen.insert(hash(i));
  EXPECT_EQ(seen.size(), 100000u);
}

TEST(Hash, FlipsHalfOfTheBits) {
  // Each of the 32 output bits flips with probability 1/2 when one input bit does. If the flips were independent, the
  // mean over 32 · 1000 trials has a standard deviation of 0.5 · sqrt(32 / 32000) = 0.016 bits. The limit is five of
  // them.
  for (const bool second_argument : {false, true}) {
    int64_t flipped = 0;
    for (uint32_t i = 0; i < 1000; ++i) {
      for (uint32_t bit = 0; bit < 32; ++bit) {
        const uint32_t other = i ^ (1u << bit);
        flipped += std::popcount(second_argument ? hash(7u, i) ^ hash(7u, other) : hash(i) ^ hash(other));
      }
    }
    EXPECT_NEAR(static_cast<double>(flipped) / 32000.0, 16.0, 0.08);
  }
}

TEST(Octahedral, KeepsDirections) {
  for (const Vec3& d : directions()) {
    EXPECT_LT(distance(direction_from_octahedral(octahedral_from_direction(d)), d), 1e-6f);
    // Half a step of 16 bits on [-1, 1] is h = 1.53e-5. Errors of h in x and y give 2 h in z. Normalising stretches
    // that by sqrt(3) in the middle of a face: 5.3e-5, plus some roundings.
    EXPECT_LT(distance(unpack_direction(pack_direction(d)), d), 5.5e-5f);
    EXPECT_NEAR(length_squared(unpack_direction(pack_direction(d))), 1.0f, 1e-6f);
  }
}

TEST(Octahedral, SquareContinuesAcrossItsBorders) {
  constexpr float kStep = 1e-3f;
  for (int i = 1; i < 100; ++i) {
    const float t = static_cast<float>(i) / 100;
    const Vec2 at[] = {{0, t}, {1, t}, {t, 0}, {t, 1}};
    const Vec2 out[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    for (int k = 0; k < 4; ++k) {
      const Vec2 wrapped = wrap_square(at[k] + kStep * out[k]);
      ASSERT_TRUE(wrapped.x >= 0 && wrapped.x < 1 && wrapped.y >= 0 && wrapped.y < 1);
      const Vec3 border = direction_from_square(at[k]);
      const Vec3 inside = direction_from_square(at[k] - kStep * out[k]);
      // Near the border, but on the other side of it.
      EXPECT_LT(glm::length(direction_from_square(wrapped) - border), 10 * kStep);
      if (i == 50) continue;  // where the border folds
      EXPECT_GT(glm::length(direction_from_square(wrapped) - inside), glm::length(inside - border));
    }
  }
  EXPECT_EQ(wrap_square(Vec2(0.25f, 0.75f)), Vec2(0.25f, 0.75f));
  for (const Vec2& corner : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1), Vec2(1, 1)}) {  // all map to one direction
    const Vec2 out = kStep * (2.0f * corner - 1.0f);
    EXPECT_LT(glm::length(wrap_square(corner + out) - (Vec2(1) - corner + out)), 1e-6f);
  }
}

TEST(Ray, OffsetOriginLeavesTheErrorBoxOnTheSideOfTheDirection) {
  const Vec3 p(100, -200, 300);
  const float error = max_component(abs(p)) * gamma_bound(5);
  for (const Vec3& n : directions()) {
    const float above = glm::dot(offset_origin(p, error, n, n) - p, n);
    const float below = glm::dot(offset_origin(p, error, n, -n) - p, n);
    // The farthest corner of the box lies at Σ |n_i| error_i; positions of this size round by up to 1.5e-5 per
    // component.
    const float box = glm::dot(abs(n), Vec3(error));
    EXPECT_NEAR(above, box, 3e-5f);
    EXPECT_NEAR(below, -box, 3e-5f);
  }
}

TEST(Vec, LeastAndLargestOfIndicesAreExact) {
  constexpr uint32_t kOdd = (1u << 24) + 1;  // the first integer that a float cannot represent
  const uint32_t least = relume::min(kOdd, kOdd + 1);
  const uint32_t largest = relume::max(kOdd, kOdd - 1);
  EXPECT_EQ(least, kOdd);
  EXPECT_EQ(largest, kOdd);
}

TEST(FixedPoint, SumsDoNotDependOnOrder) {
  constexpr uint32_t kCount = 10000;
  const auto value = [](uint32_t i) { return Rgb(to_unit_float(hash(i)), 1e6f * to_unit_float(hash(i, 1u)), -1.0f); };
  FixedPointRgb forward;
  FixedPointRgb shared;
  for (uint32_t i = 0; i < kCount; ++i) forward.add(value(i));
  std::vector<std::thread> threads;
  for (uint32_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (uint32_t i = kCount; i-- > 0;) {
        if (i % 4 == t) shared.add(value(i));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(shared.r, forward.r);
  EXPECT_EQ(shared.g, forward.g);
  EXPECT_EQ(shared.b, forward.b);
  EXPECT_EQ(forward.value().b, -10000.0f);
}

TEST(FixedPoint, RoundTripsAndSaturates) {
  EXPECT_EQ(from_fixed_point(to_fixed_point(0.5f)), 0.5f);
  EXPECT_EQ(from_fixed_point(to_fixed_point(-kFixedPointUnit)), -kFixedPointUnit);
  EXPECT_EQ(from_fixed_point(to_fixed_point(1e30f)), kFixedPointMax);
}

TEST(FixedPoint, RoundsToTheNearestUnit) {
  for (const float sign : {-1.0f, 1.0f}) {
    const auto one = static_cast<int64_t>(sign);
    EXPECT_EQ(to_fixed_point(0.25f * sign * kFixedPointUnit), 0);
    EXPECT_EQ(to_fixed_point(0.75f * sign * kFixedPointUnit), one);
    EXPECT_EQ(to_fixed_point(1.75f * sign * kFixedPointUnit), 2 * one);
    EXPECT_EQ(to_fixed_point(sign * kFixedPointMax), one << 44);
  }
}

TEST(Fnv1a, MatchesTheStandardForAnySplit) {
  const auto hash_of = [](std::string_view a, std::string_view b) {
    Fnv1a hash;
    hash.add(a.data(), a.size());
    hash.add(b.data(), b.size());
    return hash.value();
  };
  // Test vectors by the authors of FNV.
  EXPECT_EQ(hash_of("", ""), 0xcbf29ce484222325u);
  EXPECT_EQ(hash_of("a", ""), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(hash_of("foobar", ""), 0x85944171f73967e8u);
  EXPECT_EQ(hash_of("foo", "bar"), 0x85944171f73967e8u);
  EXPECT_NE(Fnv1a(1).value(), Fnv1a(0).value());
}

TEST(Euler, AnglesTakeTheRotationBack) {
  constexpr float kUlp = 6e-8f;
  for (const float x : {0.0f, 30.0f, -75.0f, 179.0f}) {
    for (const float y : {0.0f, 45.0f, 90.0f, -90.0f, 89.99f}) {
      for (const float z : {0.0f, 20.0f, -160.0f}) {
        const glm::quat exact(glm::radians(Vec3(x, y, z)));
        for (const float noise : {0.0f, kUlp, -kUlp}) {
          glm::quat q = exact;
          q.y += noise;
          q.z -= noise;
          const glm::quat back(glm::radians(euler_degrees(q)));
          for (const Vec3& v : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
            EXPECT_LT(glm::distance(back * v, q * v), 1e-5f) << x << ' ' << y << ' ' << z << ' ' << noise;
        }
      }
    }
  }
}

TEST(Memory, IsPlausible) {
  EXPECT_GT(physical_memory_bytes(), uint64_t{1} << 28);
  EXPECT_LT(physical_memory_bytes(), uint64_t{1} << 50);
}

}  // namespace
}  // namespace relume

#include "core/math.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#if defined(__SSE__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include "core/hash.h"
#include "core/parallel.h"
#include "core/vec.h"

namespace relume {
namespace {

using math::detail::bits_of;
using math::detail::float_of;
using math::detail::is_nan;

constexpr float kSmallestNormal = std::numeric_limits<float>::min();

double without_denormals(double x) { return std::fabs(x) < kSmallestNormal ? std::copysign(0.0, x) : x; }

constexpr double kWrong = std::numeric_limits<double>::infinity();

/// Distance from the exact value in units in the last place of a float; kWrong if one of them is special, or if their
/// signs differ.
double ulps(float found, double exact) {
  if (std::isnan(exact) || std::isnan(found)) return std::isnan(exact) && std::isnan(found) ? 0 : kWrong;
  if (std::isinf(found) || std::isinf(static_cast<float>(exact)))
    return found == static_cast<float>(exact) ? 0 : kWrong;
  if (exact != 0 && std::signbit(found) != std::signbit(exact)) return kWrong;
  if (std::fabs(exact) < kSmallestNormal) {
    const bool rounds_up = std::fabs(exact) > (1 - 1e-6) * static_cast<double>(kSmallestNormal);
    return found == 0 || (rounds_up && std::fabs(found) == kSmallestNormal) ? 0 : kWrong;
  }
  int exponent = 0;
  std::frexp(exact, &exponent);
  return std::fabs(found - exact) / std::ldexp(1.0, exponent - 24);
}

/// Largest error over every `step`-th bit pattern of floats.
template <typename Function, typename Exact>
double worst_ulps(uint32_t step, const Function& function, const Exact& exact) {
  constexpr uint32_t kParts = 256;
  std::vector<double> worst(kParts, 0);
  parallel_tasks(kParts, [&](size_t part) {
    const uint64_t begin = part << 24;
    for (uint64_t bits = begin; bits < begin + (1u << 24); bits += step) {
      const float x = float_of(static_cast<uint32_t>(bits));
      worst[part] = std::max(worst[part], ulps(function(x), exact(without_denormals(static_cast<double>(x)))));
    }
  });
  return *std::max_element(worst.begin(), worst.end());
}

/// A function, its exact values and the bound of its error, ulp.
struct BoundedError {
  const char* name;
  float (*function)(float);
  double (*exact)(double);
  double bound;
};

template <int numerator, int denominator>
float power(float x) {
  return math::pow(x, static_cast<float>(numerator) / denominator);
}
template <int numerator, int denominator>
double exact_power(double x) {
  return x < 0 ? NAN : std::pow(std::fabs(x), static_cast<double>(static_cast<float>(numerator) / denominator));
}

const BoundedError kErrors[] = {
    {"sin", math::sin, std::sin, 1.5},
    {"cos", math::cos, std::cos, 1.5},
    {"exp", math::exp, std::exp, 1.05},
    {"log", math::log, std::log, 1.0},
    {"log2", math::log2, std::log2, 1.0},
    {"exp2", math::exp2, std::exp2, 0.51},
    {"acos", math::acos, [](double x) { return std::acos(std::clamp(x, -1.0, 1.0)); }, 1.0},
    {"pow_12_5", power<12, 5>, exact_power<12, 5>, 0.51},
    {"pow_minus_3_5", power<-3, 5>, exact_power<-3, 5>, 0.51},
    {"pow_5_12", power<5, 12>, exact_power<5, 12>, 0.51},
    {"pow_million", power<1000003, 1>, exact_power<1000003, 1>, 0.51},
};

std::string error_name(const ::testing::TestParamInfo<BoundedError>& info) { return info.param.name; }

class MathError : public ::testing::TestWithParam<BoundedError> {};
TEST_P(MathError, IsWithinItsBound) {
  const BoundedError& e = GetParam();
  EXPECT_LE(worst_ulps(4099, e.function, e.exact), e.bound);
}
INSTANTIATE_TEST_SUITE_P(Math, MathError, ::testing::ValuesIn(kErrors), error_name);

class SlowMathError : public ::testing::TestWithParam<BoundedError> {};
TEST_P(SlowMathError, OfAllFloatsIsWithinItsBound) {
  const BoundedError& e = GetParam();
  EXPECT_LE(worst_ulps(1, e.function, e.exact), e.bound);
}
INSTANTIATE_TEST_SUITE_P(SlowMath, SlowMathError, ::testing::ValuesIn(kErrors), error_name);

/// Largest error, ulp, of function(a, b) over the pairs (a, b) = pair(i), i < count.
template <typename Pair, typename Function, typename Exact>
double worst_of_pairs(uint32_t count, const Pair& pair, const Function& function, const Exact& exact) {
  constexpr uint32_t kParts = 64;
  std::vector<double> worst(kParts, 0);
  parallel_tasks(kParts, [&](size_t part) {
    for (auto i = static_cast<uint32_t>(part); i < count; i += kParts) {
      const Vec2 p = pair(i);
      worst[part] =
          std::max(worst[part], ulps(function(p.x, p.y), exact(static_cast<double>(p.x), static_cast<double>(p.y))));
    }
  });
  return *std::max_element(worst.begin(), worst.end());
}

/// Coordinates (x, y) for atan2. Three in four ratios are near a limit of its cases; the others are 2^−50 to 2^50.
Vec2 any_direction(uint32_t i) {
  const float size = std::exp2(60.0f * (to_unit_float(hash(i, 1u)) - 0.5f));
  const float spread = 0.1f * (to_unit_float(hash(i, 2u)) - 0.5f);
  constexpr float kRatios[] = {0.41421356f, 1.0f, 2.4142135f};
  const uint32_t kind = hash(i, 3u) % 4;
  const float ratio =
      kind == 3 ? std::exp2(100.0f * (to_unit_float(hash(i, 4u)) - 0.5f)) : kRatios[kind] * (1 + spread);
  const float x = size * (1 + to_unit_float(hash(i, 5u)));
  const uint32_t signs = hash(i, 6u);
  return {(signs & 1u) ? -x : x, (signs & 2u) ? -x * ratio : x * ratio};
}

void expect_atan2(uint32_t count) {
  EXPECT_LE(worst_of_pairs(
                count, any_direction, [](float x, float y) { return math::atan2(y, x); },
                [](double x, double y) { return std::atan2(y, x); }),
            1.5);
}
TEST(Math, Atan2IsWithinItsBound) { expect_atan2(300'000); }
TEST(SlowMath, Atan2IsWithinItsBound) { expect_atan2(1'000'000'000); }

/// Base and exponent of a power between 2^−126 and 2^126; many bases are near 1, with large exponents.
Vec2 any_power(uint32_t i) {
  const float result = 252.0f * (to_unit_float(hash(i, 1u)) - 0.5f);  // its logarithm to the base 2
  const float log_x = std::exp2(-20.0f * to_unit_float(hash(i, 2u))) * (to_unit_float(hash(i, 3u)) - 0.5f);
  const float x = std::exp2(log_x);
  return {x, x == 1.0f ? 1e7f : static_cast<float>(static_cast<double>(result) / std::log2(static_cast<double>(x)))};
}
TEST(Math, PowersOfAnySizeAreWithinTheirBound) {
  EXPECT_LE(worst_of_pairs(
                300'000, any_power, [](float x, float y) { return math::pow(x, y); },
                [](double x, double y) { return std::pow(x, y); }),
            0.51);
}

TEST(Math, SpecialValues) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(is_nan(math::sin(kInfinity)) && is_nan(math::cos(-kInfinity)) && is_nan(math::sin(kNan)));
  EXPECT_EQ(math::exp(-kInfinity), 0.0f);
  EXPECT_EQ(math::exp(kInfinity), kInfinity);
  EXPECT_EQ(math::exp(0.0f), 1.0f);
  EXPECT_EQ(math::log(1.0f), 0.0f);
  EXPECT_EQ(math::log(-0.0f), -kInfinity);
  EXPECT_TRUE(is_nan(math::log(-1.0f)) && is_nan(math::log2(-kInfinity)) && is_nan(math::acos(kNan)));
  for (int n = -126; n < 128; ++n) EXPECT_EQ(math::log2(std::ldexp(1.0f, n)), static_cast<float>(n));
  for (int n = -126; n < 128; ++n) EXPECT_EQ(math::exp2(static_cast<float>(n)), std::ldexp(1.0f, n));
  EXPECT_EQ(math::pow(0.0f, 2.0f), 0.0f);
  EXPECT_EQ(math::pow(0.0f, -2.0f), kInfinity);
  EXPECT_EQ(math::pow(kInfinity, 0.0f), 1.0f);
  EXPECT_EQ(math::pow(0.5f, kInfinity), 0.0f);
  EXPECT_EQ(math::pow(0.5f, -kInfinity), kInfinity);
  EXPECT_TRUE(is_nan(math::pow(-2.0f, 2.0f)));
  EXPECT_EQ(math::acos(2.0f), 0.0f);
  EXPECT_EQ(bits_of(math::sin(-0.0f)), bits_of(0.0f));
}

#if defined(__SSE__)
/// Kernels flush denormals with Embree only; the functions give the same bits in both modes.
TEST(Math, BitsDoNotDependOnFlushing) {
  std::vector<float> arguments;
  for (int exponent = -149; exponent < 128; ++exponent) {
    for (const double mantissa : {1.0, 1.25, 1.99999994}) {
      for (const double sign : {1.0, -1.0})
        arguments.push_back(static_cast<float>(sign * std::ldexp(mantissa, exponent)));
    }
  }
  const auto results = [&] {
    std::vector<uint32_t> bits;
    for (const float x : arguments) {
      for (const BoundedError& e : kErrors) bits.push_back(bits_of(e.function(x)));
      for (const float y : arguments) bits.push_back(bits_of(math::atan2(y, x)));
    }
    return bits;
  };
  const std::vector<uint32_t> plain = results();
  const unsigned mode = _mm_getcsr();
  _mm_setcsr(mode | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON);
  const std::vector<uint32_t> flushed = results();
  _mm_setcsr(mode);
  EXPECT_EQ(flushed, plain);
}
#endif

TEST(Math, AnglesOfZerosAndInfinitiesAreThoseOfTheStandardLibrary) {
  for (const float y : {0.0f, -0.0f, 1.0f, -1.0f, kInfinity, -kInfinity}) {
    for (const float x : {0.0f, -0.0f, 1.0f, -1.0f, kInfinity, -kInfinity})
      EXPECT_EQ(bits_of(math::atan2(y, x)), bits_of(std::atan2(y, x))) << y << ' ' << x;
  }
}

TEST(Math, RoundsToTheNearestInteger) {
  for (uint32_t bits = 0; bits < 0xff000000u; bits += 4099) {
    const float x = float_of(bits);
    if (!(std::fabs(x) < 2e9f)) continue;
    ASSERT_EQ(math::round_to_int(x), std::lround(x)) << x;
  }
}

TEST(Math, IntegersSaturate) {
  EXPECT_EQ(math::round_to_int(0.49999997f), 0);
  EXPECT_EQ(math::round_to_int(-2.5f), -3);
  EXPECT_EQ(math::round_to_int(8388609.0f), 8388609);
  EXPECT_EQ(math::round_to_int(3e9f), std::numeric_limits<int32_t>::max());
  EXPECT_EQ(math::round_to_int(-3e9f), std::numeric_limits<int32_t>::min());
  EXPECT_EQ(math::round_to_int(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(Math, TruncatesToUnsignedIntegers) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  EXPECT_EQ(math::truncate_to_uint(0.99999994f), 0u);
  EXPECT_EQ(math::truncate_to_uint(63.5f), 63u);
  EXPECT_EQ(math::truncate_to_uint(4294967040.0f), 4294967040u);
  EXPECT_EQ(math::truncate_to_uint(4294967296.0f), std::numeric_limits<uint32_t>::max());
  EXPECT_EQ(math::truncate_to_uint(kInfinite), std::numeric_limits<uint32_t>::max());
  for (const float x : {-0.0f, -0.5f, -1.0f, -3e9f, -kInfinite, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_EQ(math::truncate_to_uint(x), 0u) << x;
}

TEST(Math, TruncatesToLongIntegers) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  constexpr int64_t kLeast = std::numeric_limits<int64_t>::min();
  constexpr int64_t kMost = std::numeric_limits<int64_t>::max();
  EXPECT_EQ(math::truncate_to_int64(-2.9), -2);
  EXPECT_EQ(math::truncate_to_int64(4503599627370497.0), 4503599627370497);
  EXPECT_EQ(math::truncate_to_int64(-9223372036854774784.0), -9223372036854774784);
  for (const double x : {9223372036854775808.0, 1e300, kInfinite}) EXPECT_EQ(math::truncate_to_int64(x), kMost) << x;
  for (const double x : {-9223372036854775808.0, -1e300, -kInfinite, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(math::truncate_to_int64(x), kLeast) << x;
}

}  // namespace
}  // namespace relume

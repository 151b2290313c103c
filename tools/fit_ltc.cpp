// Fits linearly transformed cosines to GGX reflection ([Heitz16]) and prints src/materials/ltc_table.cpp:
//
//   g++ -std=c++20 -O2 -Isrc tools/fit_ltc.cpp -o /tmp/fit_ltc && /tmp/fit_ltc > src/materials/ltc_table.cpp
//
// For each roughness and viewing angle, the lobe is aligned with the mean direction of reflection. The simplex method
// of Nelder and Mead fits its two widths and its shear in the plane of incidence. It minimises the cube of the
// difference between the densities.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

#include "materials/ltc.h"
#include "materials/microfacet.h"

using namespace relume;

namespace {

constexpr int kSamples = 40;  // per dimension: directions at which the densities are compared

struct Lobe {
  Microfacet microfacet;
  Vec3 wo;
  float albedo = 1;

  /// Density of reflected light, f cos θ over the albedo.
  float density(const Vec3& wi) const {
    if (wi.z <= 0.0f) return 0.0f;
    const Vec3 m = glm::normalize(wo + wi);
    return microfacet.d(m) * microfacet.g2(wo, wi) / (4.0f * wo.z) / albedo;
  }
};

Vec2 stratum(int i, int j) {
  return {(static_cast<float>(i) + 0.5f) / kSamples, (static_cast<float>(j) + 0.5f) / kSamples};
}

Vec3 reflected(const Lobe& lobe, const Vec2& u) {
  const Vec3 m = lobe.microfacet.sample(lobe.wo, u);
  return 2.0f * glm::dot(lobe.wo, m) * m - lobe.wo;
}

/// Density with which reflected() chooses.
float reflected_pdf(const Lobe& lobe, const Vec3& wi) {
  const Vec3 m = glm::normalize(lobe.wo + wi);
  return lobe.microfacet.pdf(lobe.wo, m) / (4.0f * std::fabs(glm::dot(lobe.wo, m)));
}

/// Albedo of the lobe, which is stored there, and mean direction of what it reflects.
Vec3 measure(Lobe& lobe) {
  Vec3 mean(0);
  double sum = 0;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const Vec3 wi = reflected(lobe, stratum(i, j));
      if (wi.z <= 0.0f) continue;
      const float weight = lobe.density(wi) / reflected_pdf(lobe, wi);
      sum += weight;
      mean += weight * wi;
    }
  }
  lobe.albedo = static_cast<float>(sum / (kSamples * kSamples));
  mean.y = 0;
  return glm::normalize(mean);
}

using Parameters = std::array<double, 3>;  // width in the plane of incidence, across it, shear

Mat3 transform(const Vec3& axis, const Parameters& p) {
  const Mat3 frame(Vec3(axis.z, 0, -axis.x), Vec3(0, 1, 0), axis);
  const Mat3 shape(Vec3(static_cast<float>(p[0]), 0, 0), Vec3(0, static_cast<float>(p[1]), 0),
                   Vec3(static_cast<float>(p[2]), 0, 1));
  return frame * shape;
}

LtcMatrix inverse_of(const Mat3& m) {
  const Mat3 i = glm::inverse(m);
  const float s = 1.0f / i[2][2];
  return {i[0][0] * s, i[2][0] * s, i[1][1] * s, i[0][2] * s};
}

double error(const Lobe& lobe, const Vec3& axis, const Parameters& p) {
  if (p[0] < 1e-3 || p[1] < 1e-3) return 1e30;
  const Mat3 m = transform(axis, p);
  const LtcMatrix inverse = inverse_of(m);
  double sum = 0;
  const auto add = [&](const Vec3& w) {
    const double f = lobe.density(w);
    const double g = ltc_pdf(inverse, w);
    const double difference = std::fabs(f - g);
    const double pdf = g + (w.z > -0.999f ? reflected_pdf(lobe, w) : 0.0f);
    if (pdf > 0) sum += difference * difference * difference / pdf;
  };
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      add(glm::normalize(m * cosine_hemisphere_from_square(stratum(i, j))));
      add(reflected(lobe, stratum(i, j)));
    }
  }
  return sum;
}

/// Minimum of `f` near `start`.
Parameters nelder_mead(const std::function<double(const Parameters&)>& f, const Parameters& start) {
  struct Vertex {
    Parameters p;
    double value;
  };
  std::array<Vertex, 4> simplex;
  for (size_t i = 0; i < 4; ++i) {
    simplex[i].p = start;
    if (i > 0) simplex[i].p[i - 1] += i == 3 ? 0.1 : 0.2 * start[i - 1];
    simplex[i].value = f(simplex[i].p);
  }
  for (int step = 0; step < 160; ++step) {
    std::sort(simplex.begin(), simplex.end(), [](const Vertex& a, const Vertex& b) { return a.value < b.value; });
    Parameters middle{};
    for (size_t i = 0; i < 3; ++i) {
      for (size_t c = 0; c < 3; ++c) middle[c] += simplex[i].p[c] / 3;
    }
    const auto along = [&](double t) {
      Vertex v;
      for (size_t c = 0; c < 3; ++c) v.p[c] = middle[c] + t * (simplex[3].p[c] - middle[c]);
      v.value = f(v.p);
      return v;
    };
    const Vertex mirrored = along(-1);
    if (mirrored.value < simplex[0].value) {
      const Vertex further = along(-2);
      simplex[3] = further.value < mirrored.value ? further : mirrored;
    } else if (mirrored.value < simplex[2].value) {
      simplex[3] = mirrored;
    } else {
      const Vertex nearer = along(mirrored.value < simplex[3].value ? -0.5 : 0.5);
      if (nearer.value < std::min(mirrored.value, simplex[3].value)) {
        simplex[3] = nearer;
      } else {
        for (size_t i = 1; i < 4; ++i) {
          for (size_t c = 0; c < 3; ++c) simplex[i].p[c] = 0.5 * (simplex[i].p[c] + simplex[0].p[c]);
          simplex[i].value = f(simplex[i].p);
        }
      }
    }
  }
  return std::min_element(simplex.begin(), simplex.end(),
                          [](const Vertex& a, const Vertex& b) { return a.value < b.value; })
      ->p;
}

}  // namespace

int main() {
  std::printf(
      "// Written by tools/fit_ltc.cpp.\n#include \"materials/ltc.h\"\n\nnamespace relume {\nnamespace {\n\n"
      "// clang-format off\nconstexpr LtcMatrix kEntries[kLtcTableSize * kLtcTableSize] = {\n");
  for (uint32_t row = 0; row < kLtcTableSize; ++row) {
    const float r = lerp(kLtcMinR, 1.0f, static_cast<float>(row) / (kLtcTableSize - 1));
    Parameters p{};
    for (uint32_t column = 0; column < kLtcTableSize; ++column) {
      const float x = static_cast<float>(column) / (kLtcTableSize - 1);
      const float cos_theta = std::max(1.0f - x * x, 1e-3f);
      Lobe lobe{{MicrofacetModel::ggx, r * r}, Vec3(std::sqrt(1.0f - cos_theta * cos_theta), 0, cos_theta)};
      const Vec3 axis = measure(lobe);
      if (column == 0) p = {r * r, r * r, 0};
      p = nelder_mead([&](const Parameters& q) { return error(lobe, axis, q); }, p);
      const LtcMatrix m = inverse_of(transform(axis, p));
      std::printf("{");
      const auto decimal = [&](float v, const char* after) {
        std::printf(std::fabs(v - std::round(v)) < 1e-9f ? "%.1ff%s" : "%.6gf%s", static_cast<double>(v), after);
      };
      decimal(m.a, ", ");
      decimal(m.b, ", ");
      decimal(m.c, ", ");
      decimal(m.d, column % 2 == 1 ? "},\n" : "}, ");
    }
  }
  std::printf(
      "};\n// clang-format on\n\n}  // namespace\n\nLtcTable ltc_table() { return {{kEntries, kLtcTableSize * "
      "kLtcTableSize}}; }\n\nLtcTable ltc_table(Array<LtcMatrix>& array) {\n  if (array.empty()) "
      "array.assign(kEntries);\n  return "
      "{array.view()};\n}\n\n}  // namespace relume\n");
}

#include "scene_io/coated_albedo.h"

#include <cmath>

namespace relume {
namespace {

/// Fresnel's reflectance of unpolarised light at a dielectric from outside.
double fresnel(double cosine, double ior) {
  const double inside = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
  const double parallel = (ior * cosine - inside) / (ior * cosine + inside);
  const double perpendicular = (cosine - ior * inside) / (cosine + ior * inside);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

}  // namespace

float inner_reflectance(float ior) {
  if (!(ior > 1.0001f)) return 0;
  constexpr int kSteps = 256;
  double outer = 0;  // ∫ 2 F(μ) μ dμ
  for (int i = 0; i < kSteps; ++i) {
    const double cosine = (i + 0.5) / kSteps;
    outer += 2 * fresnel(cosine, static_cast<double>(ior)) * cosine / kSteps;
  }
  return static_cast<float>(1 - (1 - outer) / static_cast<double>(ior * ior));
}

Rgb albedo_below_coat(const Rgb& albedo, float inner) { return albedo * (1 - inner) / (Rgb(1) - albedo * inner); }

Rgb albedo_without_coat(const Rgb& color, float inner) { return color / (Rgb(1 - inner) + color * inner); }

}  // namespace relume

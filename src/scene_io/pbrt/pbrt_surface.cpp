#include "scene_io/pbrt/pbrt_surface.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "core/vec.h"

namespace relume::pbrt {
namespace {

Rgb blend(const Rgb& a, const Rgb& b, float t) { return a + (b - a) * t; }

}  // namespace

float perceptual_roughness(float pbrt_roughness, bool remap) {
  const float alpha = remap ? std::sqrt(std::max(pbrt_roughness, 0.0f)) : std::max(pbrt_roughness, 0.0f);
  return std::sqrt(std::min(alpha, 1.0f));
}

Rgb reflectance_in_coat(const Rgb& reflectance, float ior) {
  const Rgb light = Rgb(1) - reflectance;
  return (sqr(ior - 1) * light + 4.0f * reflectance) / (sqr(ior + 1) * light + 4.0f * reflectance);
}

Rgb reflectance_without_coat(const Rgb& color, float ior) {
  const Rgb numerator = color * sqr(ior + 1) - sqr(ior - 1);
  return glm::max(numerator / (color * (sqr(ior + 1) - 4) + 4.0f - sqr(ior - 1)), Rgb(0));
}

float thin_wall_index(float ior) {
  const float r = sqr((ior - 1) / (ior + 1));
  const float root = std::sqrt(2 * r / (1 + r));
  return (1 + root) / (1 - root);
}

float index_of_thin_wall(float wall_ior) {
  const float wall = sqr((wall_ior - 1) / (wall_ior + 1));
  const float root = std::sqrt(wall / (2 - wall));
  return (1 + root) / (1 - root);
}

float set_anisotropy(float alpha_u, float alpha_v, Material& material) {
  const float narrow = std::min(alpha_u, alpha_v);
  const float wide = std::max(alpha_u, alpha_v);
  if (wide - narrow > 1e-4f && narrow < 1) {
    material.anisotropy = std::sqrt((std::min(wide, 1.0f) - narrow) / (1 - narrow));
    material.anisotropy_rotation_rad = alpha_u < alpha_v ? kPi / 2 : 0.0f;
  }
  return std::sqrt(std::min(narrow, 1.0f));
}

Surface mixed(const Surface& a, const Surface& b, float amount) {
  const float t = saturate(amount);
  Surface result;
  const auto lerp_to = [&](float Surface::*member) { result.*member = lerp(a.*member, b.*member, t); };
  for (float Surface::*member :
       {&Surface::alpha, &Surface::metallic, &Surface::roughness, &Surface::specular, &Surface::transmission,
        &Surface::clearcoat, &Surface::clearcoat_roughness, &Surface::diffuse_transmission})
    lerp_to(member);
  result.base_color = blend(a.base_color, b.base_color, t);
  result.specular_color = blend(a.specular_color, b.specular_color, t);
  result.diffuse_transmission_color = blend(a.diffuse_transmission_color, b.diffuse_transmission_color, t);
  return result;
}

bool have_equal_colors(const SurfaceModel& a, const SurfaceModel& b) {
  constexpr int kSamples = 32;
  constexpr float kRounding = 0.005f;
  float color = 0, roughness = 0;
  for (int i = 0; i < kSamples * kSamples; ++i) {
    const Vec2 uv((static_cast<float>(i % kSamples) + 0.5f) / kSamples,
                  (static_cast<float>(i / kSamples) + 0.5f) / kSamples);
    const Surface p = a.at(uv), q = b.at(uv);
    color += max_component(glm::abs(p.base_color - q.base_color)) / (kSamples * kSamples);
    roughness += std::fabs(p.roughness - q.roughness) / (kSamples * kSamples);
  }
  return color <= kRounding && roughness <= kRounding;
}

Surface covered(const Surface& base, float base_f0, const Surface& metal, float share) {
  if (share >= 1) return metal;
  Surface result = base;
  if (share > 0) result.roughness = metal.roughness;
  const float own = (1 - share) * base.specular;
  const Rgb own_f0 = own * base_f0 * base.specular_color;
  const Rgb f0 = metal.base_color * share + own_f0;
  result.specular = share + own;
  result.specular_color = result.specular > 0 ? f0 / result.specular : Rgb(0);
  // The layer transmits 1 - f0; the base should receive what its own coat and its share leave.
  result.base_color = base.base_color * (Rgb(1 - share) - own_f0) / (Rgb(1) - f0 + Rgb(1e-6f));
  return result;
}

}  // namespace relume::pbrt

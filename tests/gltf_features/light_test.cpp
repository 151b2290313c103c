// Tests KHR_lights_punctual with a matte square under each light, and the view of each camera.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "gltf_features/stage.h"

namespace relume::support {
namespace {

constexpr double kAlbedo = 0.5;

/// Image of the matte square under one light, without bounces.
Image under(const json& light, const json& node) {
  Stage stage;
  stage.show(stage.square(), matte_json(static_cast<float>(kAlbedo)));
  stage.light(light, node);
  return image(stage.load(), 16, 64);
}

/// Lambertian reflection of an irradiance.
Rgb reflected(const glm::dvec3& irradiance) { return Rgb(irradiance * (kAlbedo / std::numbers::pi)); }

const glm::dvec3 kColor = {1, 0.5, 0.25};

TEST(Punctual, DirectionalIsTheSameEverywhere) {  // lux, along -Z of its node, at any position
  const Image image = under({{"type", "directional"}, {"color", {1, 0.5, 0.25}}, {"intensity", 7}},
                            {{"rotation", rotation_json({0, 1, 0}, 0.9f)}, {"translation", {3, -100, -5}}});
  expect_pixels(image, 1e-4, [](double, double) { return reflected(7 * std::cos(0.9) * kColor); });
}

TEST(Punctual, PointFallsWithTheSquareOfDistance) {  // candela
  const Image image =
      under({{"type", "point"}, {"color", {1, 0.5, 0.25}}, {"intensity", 7}}, {{"translation", {0.5, -0.25, 1.5}}});
  expect_pixels(image, 0.01, [](double x, double y) {  // jitter within a pixel
    const glm::dvec3 d(0.5 - x, -0.25 - y, 1.5);
    return reflected(7 * d.z / std::pow(glm::length(d), 3) * kColor);
  });
}

TEST(Punctual, SpotFadesBetweenItsCones) {  // the extension's suggestion: square of a ramp in the cosine
  constexpr double kInner = 0.2;
  constexpr double kOuter = 0.5;
  const Image image =
      under({{"type", "spot"}, {"intensity", 7}, {"spot", {{"innerConeAngle", kInner}, {"outerConeAngle", kOuter}}}},
            {{"translation", {0, 0, 1.8}}});
  expect_pixels(image, 0.03, [](double x, double y) {  // jitter within a pixel, steep at the cone's edge
    const glm::dvec3 d(-x, -y, 1.8);
    const double cosine = d.z / glm::length(d);
    const double ramp = (cosine - std::cos(kOuter)) / (std::cos(kInner) - std::cos(kOuter));
    const double share = std::pow(glm::clamp(ramp, 0.0, 1.0), 2);
    return reflected(glm::dvec3(7 * share * cosine / glm::dot(d, d)));
  });
}

TEST(Punctual, NodesPlaceAndTurnButDoNotScaleIntensity) {
  const json light = {{"type", "spot"}, {"intensity", 7}, {"spot", {{"outerConeAngle", 0.6}}}};
  const Image plain = under(light, {{"translation", {0, 0, 1.8}}});
  expect_same(under(light, {{"translation", {0, 0, 1.8}}, {"scale", {3, 3, 3}}}), plain, 1e-5);
}

TEST(Cameras, PerspectiveSeesItsVerticalAngle) {
  // From 2 m, an angle of 90° covers 4 m: the square fills the middle half of the image in both directions.
  Stage stage;
  stage.file.doc["cameras"][0] = {{"type", "perspective"},
                                  {"perspective", {{"yfov", std::numbers::pi / 2}, {"znear", 0.1}}}};
  stage.file.doc["nodes"][0]["translation"] = {0, 0, 2};
  stage.show(stage.square(), unlit_json({}, {0.5, 0.25, 0.125, 1}));
  expect_pixels(image(stage.load()), 1e-5, [](double x, double y) {
    return std::fabs(x) < 0.5 && std::fabs(y) < 0.5 ? Rgb(0.5f, 0.25f, 0.125f) : Rgb(0);
  });
}

TEST(Cameras, OrthographicSeesItsHeight) {
  Stage stage;
  stage.file.doc["cameras"][0]["orthographic"]["ymag"] = 4;
  stage.show(stage.square(), unlit_json({}, {0.5, 0.25, 0.125, 1}));
  expect_pixels(image(stage.load()), 1e-5, [](double x, double y) {
    return std::fabs(x) < 0.25 && std::fabs(y) < 0.25 ? Rgb(0.5f, 0.25f, 0.125f) : Rgb(0);
  });
}

TEST(Cameras, MoveWithTheirNodes) {  // half a second into a motion to the right at 2 m/s
  Stage stage;
  stage.animate(0, "translation", {0, 1}, {0, 0, 5, 2, 0, 5}, 3);
  stage.show(stage.square(), unlit_json({}, {0.5, 0.25, 0.125, 1}));
  expect_pixels(image(stage.load()), 1e-5, [](double x, double) { return x < 0 ? Rgb(0.5f, 0.25f, 0.125f) : Rgb(0); });
}

}  // namespace
}  // namespace relume::support

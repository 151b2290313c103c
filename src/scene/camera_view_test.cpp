// Contract of every projection: rays and raster positions are inverse, importance and densities are normalised.
#include "scene/camera_view.h"

#include <gtest/gtest.h>

#include <vector>

#include "testing/histogram.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::Random;

struct NamedCamera {
  std::string name;
  CameraView view;
};

std::vector<NamedCamera> cameras() {
  CameraView base;
  base.position = Vec3(1, 2, 3);
  base.axes = make_frame(glm::normalize(Vec3(0.3f, -0.2f, 0.9f)));
  base.resolution = Vec2(320, 200);
  base.half_extent = Vec2(0.8f, 0.5f);
  std::vector<NamedCamera> list{{"pinhole", base}, {"thin lens", base}, {"orthographic", base}, {"panoramic", base}};
  list[1].view.lens_radius = 0.05f;
  list[1].view.focus_distance = 2.5f;
  list[2].view.projection = Projection::orthographic;
  list[3].view.projection = Projection::panoramic;
  return list;
}

TEST(Camera, RasterPositionInvertsGenerate) {
  for (const auto& [name, c] : cameras()) {
    Random random(91);
    for (int i = 0; i < 5000; ++i) {
      const Vec2 raster = random.next_2d() * c.resolution;
      const Ray ray = generate(c, raster, random.next_2d());
      ASSERT_NEAR(glm::length(ray.direction), 1.0f, 1e-5f) << name;
      Vec2 back;
      const bool inside = raster_position(c, ray, &back);
      // A tolerance of 10⁻⁵ of the image; at its edges rounding may leave the image.
      const bool at_edge = raster.x < 0.01f || raster.y < 0.01f || raster.x > c.resolution.x - 0.01f ||
                           raster.y > c.resolution.y - 0.01f;
      ASSERT_TRUE(inside || at_edge) << name;
      const float scale =
          name == "panoramic" ? 1.0f / std::fmax(0.01f, std::sin(raster.y / c.resolution.y * kPi)) : 1.0f;
      ASSERT_NEAR(back.x, raster.x, 5e-3f * scale) << name;
      ASSERT_NEAR(back.y, raster.y, 5e-3f * scale) << name;
    }
  }
}

TEST(Camera, PanoramasEndBeforeTheirResolution) {
  CameraView c = cameras()[3].view;
  c.axes = make_frame(Vec3(0, 0, 1));
  const Vec3 down = -c.axes.b;
  const Vec3 back = c.axes.n;
  for (const Vec3& direction : {down, back, glm::normalize(down + 1e-5f * c.axes.t),
                                glm::normalize(back + 1e-9f * c.axes.t), glm::normalize(back - 1e-9f * c.axes.t)}) {
    Vec2 raster;
    ASSERT_TRUE(raster_position(c, {c.position, direction, kInfinity}, &raster));
    EXPECT_LT(raster.x, c.resolution.x);
    EXPECT_LT(raster.y, c.resolution.y);
    EXPECT_GE(raster.x, 0.0f);
    EXPECT_GE(raster.y, 0.0f);
  }
}

TEST(Camera, TheImageIsUprightAndNotMirrored) {
  for (const NamedCamera& camera : cameras()) {
    const auto& name = camera.name;
    const CameraView& c = camera.view;
    const auto looks = [&](float x, float y) {
      const Ray r = generate(c, Vec2(x, y) * c.resolution, Vec2(0.5f));
      return name == "orthographic" ? r.origin - c.position : r.direction;
    };
    EXPECT_GT(glm::dot(looks(0.7f, 0.5f), c.axes.t), 0.0f) << name;  // right
    EXPECT_GT(glm::dot(looks(0.5f, 0.3f), c.axes.b), 0.0f) << name;  // up: raster y points down
    const Ray centre = generate(c, c.resolution * 0.5f, Vec2(0.5f));
    EXPECT_LT(glm::dot(centre.direction, c.axes.n), -0.999f) << name;
  }
}

TEST(Camera, ThinLensIsSharpAtTheFocalPlane) {
  const CameraView c = cameras()[1].view;
  const Vec2 raster(100, 60);
  const Ray first = generate(c, raster, Vec2(0.1f, 0.9f));
  const auto at_focus = [&](const Ray& r) {
    return r.origin + r.direction * (c.focus_distance / -glm::dot(r.direction, c.axes.n) +
                                     glm::dot(r.origin - c.position, c.axes.n));
  };
  Random random(92);
  for (int i = 0; i < 100; ++i) {
    const Ray ray = generate(c, raster, random.next_2d());
    EXPECT_LT(glm::length(at_focus(ray) - at_focus(first)), 1e-5f);
    EXPECT_LE(glm::length(ray.origin - c.position), c.lens_radius * 1.0001f);
  }
}

/// |cos| between a camera's rays and its lens or sensor; 1 for a panoramic point.
float lens_cosine(const CameraView& c, const Ray& ray) {
  return c.projection == Projection::panoramic ? 1.0f : std::fabs(glm::dot(ray.direction, c.axes.n));
}

TEST(Camera, ImportanceIsTheSamplingDensityPerCosine) {
  // A camera ray then has the weight We cos / (pdf_a pdf_w) = 1.
  for (const auto& [name, c] : cameras()) {
    Random random(93);
    for (int i = 0; i < 2000; ++i) {
      const Vec2 raster = (random.next_2d() * 0.98f + 0.01f) * c.resolution;
      const Ray ray = generate(c, raster, random.next_2d());
      const CameraPdf pdf = pdf_we(c, ray);
      ASSERT_GT(pdf.pdf_w, 0.0f) << name;
      ASSERT_NEAR(we(c, ray) * lens_cosine(c, ray) / (pdf.pdf_a * pdf.pdf_w), 1.0f, 1e-4f) << name;
    }
  }
}

/// χ²: raster positions uniform over the image follow the densities of pdf_we().
TEST(Camera, RaysFollowTheirDensity) {
  constexpr int kSamples = 200000;
  for (const NamedCamera& camera : cameras()) {
    const auto& name = camera.name;
    const CameraView& c = camera.view;
    Random random(96);
    testing::Histogram histogram(16);
    if (c.projection == Projection::orthographic) {
      // Position on a square around the smaller sensor.
      const auto place = [&c = c](double x, double y) {
        return c.position + c.axes.to_world(Vec3(2.0 * x - 1.0, 2.0 * y - 1.0, 0.0));
      };
      for (int i = 0; i < kSamples; ++i) {
        const Vec3 local =
            c.axes.to_local(generate(c, random.next_2d() * c.resolution, Vec2(0.5f)).origin - c.position);
        histogram.add(0.5 * (local.x + 1.0), 0.5 * (local.y + 1.0));
      }
      const auto density = [&](double x, double y) {
        return 4.0 * pdf_we(c, {place(x, y), -c.axes.n, kInfinity}).pdf_a;
      };
      EXPECT_GT(histogram.test(density, 8).p_value, testing::significance()) << name;
      continue;
    }
    // All rays through one point of the lens.
    const Vec2 u_lens(0.2f, 0.7f);
    const Vec3 origin = generate(c, 0.5f * c.resolution, u_lens).origin;
    const testing::DirectionChart chart{{c.axes.t, c.axes.b, -c.axes.n}, 1.0};
    for (int i = 0; i < kSamples; ++i) {
      const Vec2 p = chart.coordinates(generate(c, random.next_2d() * c.resolution, u_lens).direction);
      histogram.add(p.x, p.y);
    }
    const auto pdf = [&](const Vec3& w) { return double{pdf_we(c, {origin, w, kInfinity}).pdf_w}; };
    constexpr double kMaxStrays = 2e-4;  // the image edges cut bins, and quadrature misses slivers of them
    EXPECT_GT(histogram.test(chart.density(pdf), 8, 1, kMaxStrays).p_value, testing::significance()) << name;
  }
}

TEST(Camera, DensitiesIntegrateToOne) {
  // ∫ pdf_w over directions, uniform over the sphere around the centre of the lens. For orthographic cameras, over the
  // plane of the sensor.
  for (const auto& [name, c] : cameras()) {
    Random random(94);
    double pdf_sum = 0;
    double importance = 0;
    constexpr int kSamples = 400000;
    for (int i = 0; i < kSamples; ++i) {
      Ray ray{c.position, random.direction(), kInfinity};
      double volume = 4.0 * M_PI;
      if (c.projection == Projection::orthographic) {
        ray.direction = -c.axes.n;
        ray.origin = c.position + c.axes.to_world(Vec3((random.next_2d() * 2.0f - 1.0f) * 2.0f, 0.0f));
        volume = 16.0;
      } else if (c.lens_radius > 0.0f) {
        ray.origin += c.axes.to_world(Vec3(disk_from_square(random.next_2d()) * c.lens_radius, 0.0f));
      }
      const CameraPdf pdf = pdf_we(c, ray);
      const double lens = c.projection == Projection::perspective && c.lens_radius > 0.0f ? c.lens_area() : 1.0;
      const double density = c.projection == Projection::orthographic ? pdf.pdf_a : pdf.pdf_w;
      pdf_sum += density * volume / kSamples;
      importance += we(c, ray) * lens_cosine(c, ray) * volume * lens / kSamples;
    }
    // The image covers a tenth of the sphere: the standard error is about 0.5 %.
    EXPECT_NEAR(pdf_sum, 1.0, 0.025) << name;
    EXPECT_NEAR(importance, 1.0, 0.025) << name;
  }
}

TEST(Camera, ConnectionsMatchTheRaysThatReachThePoint) {
  for (const auto& [name, c] : cameras()) {
    Random random(95);
    int found = 0;
    for (int i = 0; i < 2000; ++i) {
      const Ray primary = generate(c, random.next_2d() * c.resolution, random.next_2d());
      const Vec3 p = primary.origin + primary.direction * (0.5f + 4.0f * random.next());
      const CameraSample s = sample_wi(c, p, random.next_2d());
      if (!s.valid()) continue;  // p may be outside the view from another point of the lens
      ++found;
      ASSERT_NEAR(glm::length(s.wi), 1.0f, 1e-5f) << name;
      const Ray back{p + s.wi * s.distance, -s.wi, kInfinity};
      Vec2 raster;
      ASSERT_TRUE(raster_position(c, back, &raster) || s.raster.x < 0.1f || s.raster.y < 0.1f ||
                  s.raster.x > c.resolution.x - 0.1f || s.raster.y > c.resolution.y - 0.1f)
          << name;
      ASSERT_NEAR(raster.x, s.raster.x, 0.05f) << name;
      ASSERT_NEAR(raster.y, s.raster.y, 0.05f) << name;
      ASSERT_NEAR(we(c, back), s.importance, 1e-3f * s.importance) << name;
      // Density of wi: that of the lens, seen from p.
      const float lens_pdf =
          c.projection == Projection::perspective && c.lens_radius > 0.0f ? 1.0f / c.lens_area() : 1.0f;
      const float cosine = c.projection == Projection::panoramic ? 1.0f : lens_cosine(c, back);
      const float expected = c.projection == Projection::orthographic ? 1.0f : lens_pdf * sqr(s.distance) / cosine;
      ASSERT_NEAR(s.pdf_w, expected, 1e-3f * expected) << name;
      ASSERT_EQ(s.delta, name != "thin lens");
    }
    EXPECT_GT(found, 1500) << name;
  }
}

TEST(Camera, SeesNothingBehindOrBesideIt) {
  for (const auto& [name, c] : cameras()) {
    if (c.projection == Projection::panoramic) continue;
    EXPECT_FALSE(sample_wi(c, c.position + c.axes.n * 2.0f, Vec2(0.5f)).valid()) << name;
    EXPECT_FALSE(sample_wi(c, c.position - c.axes.n + c.axes.t * 5.0f, Vec2(0.5f)).valid()) << name;
  }
}

TEST(Camera, ConesCoverPixels) {
  // Pixels times spread equal the image height at distance 1, or half a turn.
  const auto list = cameras();
  EXPECT_FLOAT_EQ(list[0].view.cone_spread() * 200.0f, 1.0f);
  EXPECT_FLOAT_EQ(list[2].view.cone_width() * 200.0f, 1.0f);
  EXPECT_EQ(list[2].view.cone_spread(), 0.0f);
  EXPECT_FLOAT_EQ(list[3].view.cone_spread() * 200.0f, kPi);
}

}  // namespace
}  // namespace relume

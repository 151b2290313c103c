#include "lights/sample_lights.h"

namespace relume {

namespace {

/// Collects lights of one shape that are sampled by solid angle, and samples eight at once.
class WideLights {
 public:
  WideLights(const LightsView& view, View<const LightRequest> requests, LightSample* samples, bool is_parallelogram)
      : view_(view), requests_(requests), samples_(samples), is_parallelogram_(is_parallelogram) {}

  void add(uint32_t request, const EmitterShape<float>& s) {
    const Vec2& u = requests_[request].u;
    const float values[kColumns] = {s.corner.x, s.corner.y, s.corner.z, s.e1.x,   s.e1.y, s.e1.z,
                                    s.e2.x,     s.e2.y,     s.e2.z,     s.volume, u.x,    u.y};
    for (uint32_t c = 0; c < kColumns; ++c) columns_[c][count_] = values[c];
    places_[count_++] = request;
    if (count_ == kLanes) sample();
  }

  /// Samples the remaining lights.
  void sample() {
    if (count_ == 0) return;
    // Unused lanes repeat a light: their values must not slow down the processor.
    for (uint32_t i = count_; i < kLanes; ++i) {
      for (auto& column : columns_) column[i] = column[0];
    }
    const auto vector = [&](uint32_t c) -> Triple<Lanes> { return {lanes(c), lanes(c + 1), lanes(c + 2)}; };
    const EmitterShape<Lanes> shape{vector(0), vector(3), vector(6), lanes(9), is_parallelogram_};
    Lanes x;
    Lanes y;
    const Lanes pdf_w = sample_solid_angle(shape, lanes(10), lanes(11), x, y);
    for (uint32_t i = 0; i < count_; ++i) {
      const LightRequest& r = requests_[places_[i]];
      samples_[places_[i]] =
          light_from(view_.lights[r.light].triangle, view_.textured, r.position, Vec2(x[i], y[i]), pdf_w[i], true);
    }
    count_ = 0;
  }

 private:
  static constexpr uint32_t kColumns = 12;

  Lanes lanes(uint32_t column) const { return load_lanes(columns_[column]); }

  const LightsView& view_;
  View<const LightRequest> requests_;
  LightSample* samples_;
  bool is_parallelogram_;
  uint32_t count_ = 0;
  uint32_t places_[kLanes] = {};
  float columns_[kColumns][kLanes];  // three vectors, volume, random numbers
};

}  // namespace

void sample_lights(const LightsView& view, View<const LightRequest> requests, LightSample* samples) {
  WideLights triangles(view, requests, samples, false);
  WideLights parallelograms(view, requests, samples, true);
  for (uint32_t i = 0; i < requests.size; ++i) {
    const LightRequest& r = requests[i];
    const Light& light = view.lights[r.light];
    if (light.kind == LightKind::triangle && !moves(view, r.light)) {
      const TriangleLight& t = light.triangle;
      const Vec3 corner = t.v0 - r.position;
      if (t.emission_cosine(-corner) > 0.0f && is_wide(t, corner, view.wide_triangle)) {
        (t.is_parallelogram ? parallelograms : triangles).add(i, shape_at(t, corner));
        continue;
      }
    }
    samples[i] = sample_li(view, r.light, r.position, r.u, r.time);
  }
  triangles.sample();
  parallelograms.sample();
}

}  // namespace relume

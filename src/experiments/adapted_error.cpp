#include "experiments/adapted_error.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "report/pictures.h"

namespace relume {
namespace {

using Clock = std::chrono::steady_clock;

/// A contender under way.
struct Running {
  Session session;
  std::vector<PassTime> passes_before = {};
  AdaptedError result = {};
};

double render(Session& session) {
  const Clock::time_point start = Clock::now();
  session.render_frame();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void measure_frame(Running& r, const Reference& reference, const std::vector<PictureRegion>& regions) {
  r.result.frame_s.push_back(render(r.session));
  r.result.last = r.session.image();
  for (size_t i = 0; i < regions.size(); ++i)
    r.result.mse[i].push_back(frame_mse(r.result.last, reference.image, regions[i]) - reference_noise(reference, regions[i]));
}

AdaptedError finish(Running& r, int frames) {
  const Statistics& statistics = r.session.statistics();
  for (const PassTime& pass : statistics.passes) {
    double seconds = pass.seconds;
    for (const PassTime& before : r.passes_before) {
      if (before.name == pass.name) seconds -= before.seconds;
    }
    r.result.pass_s.emplace_back(pass.name, seconds / frames);
  }
  r.result.figures = statistics.figures;
  return std::move(r.result);
}

}  // namespace

size_t PictureRegion::pixels() const {
  return mask.size() - static_cast<size_t>(std::count(mask.begin(), mask.end(), uint8_t{0}));
}

PictureRegion whole_picture(int width, int height) {
  return {"picture", std::vector<uint8_t>(static_cast<size_t>(width) * static_cast<size_t>(height), 1)};
}

double frame_mse(const Image& frame, const Image& reference, const PictureRegion& region) {
  double sum = 0;
  for (size_t p = 0; p < frame.pixels.size(); ++p) {
    if (region.mask[p] == 0) continue;
    const glm::dvec3 d = glm::dvec3(frame.pixels[p]) - glm::dvec3(reference.pixels[p]);
    sum += glm::dot(d, d);
  }
  return sum / (3.0 * static_cast<double>(std::max<size_t>(region.pixels(), 1)));
}

double reference_noise(const Reference& reference, const PictureRegion& region) {
  double sum = 0;
  for (size_t p = 0; p < reference.squared_error.pixels.size(); ++p) {
    if (region.mask[p] == 0) continue;
    for (int c = 0; c < 3; ++c) sum += static_cast<double>(reference.squared_error.pixels[p][c]);
  }
  return sum / (3.0 * static_cast<double>(std::max<size_t>(region.pixels(), 1)));
}

std::vector<AdaptedError> measure_adapted(const ExperimentContext& context, const ExperimentScene& scene,
                                          const std::vector<AdaptedContender>& contenders, const Reference& reference,
                                          const std::vector<PictureRegion>& regions, const AdaptedOptions& options) {
  std::vector<Running> running;
  for (const AdaptedContender& contender : contenders) {
    RenderSettings settings = contender.settings;
    settings.history = HistoryChoice::none;
    settings.seed = options.seed;
    running.push_back({Session(Scene(scene.scene), settings)});
    running.back().session.set_camera(scene.camera);
    running.back().result.name = contender.name;
    running.back().result.mse.resize(regions.size());
  }
  const int all = options.warm_up + options.frames;
  for (int frame = 0; frame < all; ++frame) {
    for (Running& r : running) {
      context.check_stop();
      if (frame < options.warm_up) {
        render(r.session);
        continue;
      }
      if (frame == options.warm_up) r.passes_before = r.session.statistics().passes;
      measure_frame(r, reference, regions);
    }
    context.report(scene.name, (frame + 1.0) / all);
  }
  std::vector<AdaptedError> results;
  for (Running& r : running) results.push_back(finish(r, options.frames));
  return results;
}

ErrorRatio error_ratio(const std::vector<double>& a, const std::vector<double>& b) {
  const double mean_a = mean(a);
  const double mean_b = mean(b);
  ErrorRatio ratio;
  ratio.value = mean_b > 0 ? mean_a / mean_b : 0;
  const auto relative_variance = [](const std::vector<double>& values, double m) {
    const double s = standard_deviation(values);
    return m > 0 ? s * s / (m * m * static_cast<double>(values.size())) : 0.0;
  };
  const double spread = std::exp(1.96 * std::sqrt(relative_variance(a, mean_a) + relative_variance(b, mean_b)));
  ratio.interval = {ratio.value / spread, ratio.value * spread, 0.95};
  return ratio;
}

ErrorRatio equal_time_ratio(const AdaptedError& a, const AdaptedError& b, size_t region) {
  ErrorRatio ratio = error_ratio(a.mse[region], b.mse[region]);
  const double times = b.median_s() > 0 ? a.median_s() / b.median_s() : 0;
  ratio.value *= times;
  ratio.interval.low *= times;
  ratio.interval.high *= times;
  return ratio;
}

std::string to_text(const ErrorRatio& ratio) {
  return fmt::format("{:.3g}× ({:.3g} to {:.3g})", ratio.value, ratio.interval.low, ratio.interval.high);
}

PictureSet adapted_pictures(const std::string& label, const std::vector<AdaptedError>& errors, const Image& reference) {
  const PictureOptions options{.tone_map = ToneMap::agx, .exposure = 0, .values = false};
  PictureSet set{.label = label, .width = reference.width, .height = reference.height, .pictures = {}, .crops = {}};
  set.pictures.push_back(plain_picture("reference", kNeutralColor, reference, options));
  std::vector<const Image*> images;
  int color = 0;
  for (const AdaptedError& e : errors) {
    set.pictures.push_back(measured_picture(e.name, color++, e.last, reference, options));
    set.pictures.back().note = fmt::format("MSE {:.2e}", e.mean_mse());
    images.push_back(&e.last);
  }
  set.crops = interesting_crops(images, reference, 3);
  return set;
}

std::vector<std::pair<std::string, std::string>> adapted_setup(const ExperimentContext& context) {
  return {{"Size", context.quick ? "64 × 36" : "192 × 108"},
          {"Path", "two indirect rays, as in the paper"},
          {"Reference", context.quick ? "256 samples" : "2048 samples"},
          {"Frames", context.quick ? "8 to warm up, 8 measured" : "128 to warm up, 256 measured"},
          {"Times", "contenders take turns frame by frame"}};
}

}  // namespace relume

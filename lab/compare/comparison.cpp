#include "compare/comparison.h"

#include <algorithm>

#include <fmt/format.h>

#include "compare/rounds.h"
#include "metrics/statistics.h"
#include "metrics/temporal.h"
#include "relume/error.h"
#include "relume/lab/metrics.h"
#include "render/display.h"
#include "scene/scene_hash.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

std::vector<std::pair<std::string, std::string>> differences_from_defaults(AllSettings settings, AllSettings defaults) {
  std::vector<std::pair<std::string, std::string>> result;
  const SettingList list = describe(settings);
  for (const Setting* setting : differing_settings(list, describe(defaults)))
    result.emplace_back(setting->name, to_string(*setting));
  return result;
}

void check_size(const std::string& file, const Image& image, int width, int height) {
  if (image.width == width && image.height == height) return;
  throw Error(fmt::format("{} has {}x{} pixels, but {}x{} are compared; give --width and --height", file, image.width,
                          image.height, width, height));
}

uint64_t count_nonfinite(const Image& image) {
  return static_cast<uint64_t>(
      std::count_if(image.pixels.begin(), image.pixels.end(), [](const Rgb& pixel) { return !is_finite(pixel); }));
}

void check_finite(const std::string& file, const Image& image) {
  if (count_nonfinite(image) < image.pixels.size()) return;
  throw Error(fmt::format("{}: the image has no finite pixel; check its source", file));
}

class Comparing {
 public:
  Comparing(const Scene& scene, const ComparisonOptions& options, const std::stop_token& stop,
            const ComparisonProgress& progress)
      : scene_(scene), stop_(stop), progress_(progress) {
    result_.options = options;
    result_.scene_hash = scene_hash(scene);
    result_.triangles = placed_triangles(scene);
  }

  std::optional<Comparison> run() {
    prepare();
    if (!make_references() || !measure_contenders()) return std::nullopt;
    measure_images();
    judge_references();
    result_.reference = std::move(references_.back());
    result_.notes = limits_of(result_);
    return std::move(result_);
  }

 private:
  const ComparisonOptions& options() const { return result_.options; }
  std::function<void(double)> stage(std::string name) const {
    return [this, name = std::move(name)](double fraction) {
      if (progress_) progress_(name, fraction);
    };
  }

  void prepare();
  void read_images();
  bool make_references();
  bool measure_contenders();
  void measure_images();
  void judge_references();

  const Scene& scene_;
  const std::stop_token& stop_;
  const ComparisonProgress& progress_;
  std::vector<AllSettings> settings_;  ///< of each contender
  std::vector<Image> images_;          ///< the external images
  std::vector<Reference> references_;
  Comparison result_;
};

void Comparing::prepare() {
  const ComparisonOptions& o = options();
  AllSettings common = resolve(o.common);
  for (const Contender& contender : o.contenders) {
    AllSettings settings = resolve_contender(contender, o.common);
    if (!o.times_s.empty()) settings.render.time_s = o.times_s.front();
    result_.contenders.push_back({.name = contender.name,
                                  .settings = settings_to_json(describe(settings)),
                                  .differences = differences_from_defaults(settings, common)});
    settings_.push_back(std::move(settings));
  }
  ReferenceSettings reference = resolve_reference(o.common, settings_, o.reference_settings);
  result_.reference_settings = std::move(reference.settings);
  result_.reference_left_out = std::move(reference.left_out);
  read_images();
}

/// Reads all files before any rendering, which may take long.
void Comparing::read_images() {
  const ComparisonOptions& o = options();
  const RenderSettings& size = result_.reference_settings.render;
  for (const ImageContender& image : o.images) {
    images_.push_back(read_whole_image(image.file));
    check_size(image.file.string(), images_.back(), size.width, size.height);
    check_finite(image.file.string(), images_.back());
  }
  if (o.reference_file.empty()) return;
  if (is_animation(o)) throw Error("--reference reads one image, but --frames compares several; remove one of the two");
  references_.push_back(read_reference(o.reference_file));
  check_size(o.reference_file.string(), references_.back().image, size.width, size.height);
  check_finite(o.reference_file.string(), references_.back().image);
}

bool Comparing::make_references() {
  const ComparisonOptions& o = options();
  if (!references_.empty()) return true;
  ReferenceRenderer renderer(scene_, result_.reference_settings.render, o.reference_spp, o.cache_folder, o.program);
  const std::vector<float> times =
      o.times_s.empty() ? std::vector<float>{result_.reference_settings.render.time_s} : o.times_s;
  const auto progress = stage("reference");
  for (size_t i = 0; i < times.size(); ++i) {
    const float previous = times[i > 0 ? i - 1 : 0];
    std::optional<Reference> reference = renderer.render(times[i], previous, std::nullopt, stop_, [&](double fraction) {
      progress((static_cast<double>(i) + fraction) / static_cast<double>(times.size()));
    });
    if (!reference) return false;
    references_.push_back(std::move(*reference));
  }
  return true;
}

bool Comparing::measure_contenders() {
  const ComparisonOptions& o = options();
  Sessions sessions;
  for (const AllSettings& settings : settings_) {
    if (stop_.stop_requested()) return false;
    sessions.push_back(std::make_unique<TimedSession>(scene_, settings.render, o.clock));
    sessions.back()->session().shorten_preparation_on(stop_);
  }
  if (!sessions.empty()) result_.threads = sessions.front()->session().statistics().threads;
  FramePlan plan{.frames = {}, .samples = static_cast<double>(o.spp)};
  if (o.budget_s > 0 && !sessions.empty()) {
    const std::optional<EqualTime> equal = plan_equal_time(sessions, o.times_s, o.budget_s, stop_, stage("timing"));
    if (!equal) return false;
    plan.frames = equal->frames;
    result_.budget_spread = equal->spread();
  }
  std::vector<Ensemble> ensembles(sessions.size());
  const auto progress = stage("contenders");
  for (int repetition = 0; repetition < o.repetitions && !sessions.empty(); ++repetition) {
    std::vector<Repetition> results;
    std::vector<Image> images;
    const bool done = run_repetition(
        sessions, o, plan, references_, repetition, stop_, results, images,
        [&](double fraction) { progress((repetition + fraction) / static_cast<double>(o.repetitions)); });
    if (!done) return false;
    for (size_t i = 0; i < sessions.size(); ++i) {
      ensembles[i].add(images[i]);
      result_.contenders[i].repetitions.push_back(std::move(results[i]));
      if (repetition == 0) result_.contenders[i].image = images[i];
      if (o.keep_images) result_.contenders[i].images.push_back(std::move(images[i]));
    }
  }
  const Reference& last = references_.back();
  for (size_t i = 0; i < sessions.size() && o.repetitions > 1; ++i)
    result_.contenders[i].split = ensembles[i].split(last.image, last.mse);
  return true;
}

void Comparing::measure_images() {
  const Display display = fixed_display(resolve(options().common).output);
  const Image& reference = references_.back().image;
  for (size_t i = 0; i < images_.size(); ++i) {
    const ImageContender& image = options().images[i];
    ContenderResult contender{.name = image.name, .is_image = true, .settings = image.file.string()};
    contender.image = std::move(images_[i]);
    const Metrics m =
        compute_metrics(contender.image, reference, {.tone_map = display.tone_map, .exposure = display.exposure});
    contender.repetitions.push_back(
        {.mse = m.mse, .rel_mse = m.rel_mse, .mape = m.mape, .flip = m.flip, .nonfinite = m.nonfinite_a});
    result_.contenders.push_back(std::move(contender));
  }
}

/// Estimates the references' contribution to the measured errors.
void Comparing::judge_references() {
  ReferenceNoise& noise = result_.reference_noise;
  const double frames = static_cast<double>(references_.size());
  for (size_t i = 0; i < references_.size(); ++i) {
    const Reference& now = references_[i];
    result_.reference_nonfinite += count_nonfinite(now.image);
    noise.mse += now.mse / frames;
    noise.rel_mse += now.rel_mse / frames;
    if (i == 0) continue;
    const Reference& before = references_[i - 1];
    const TemporalError temporal =
        temporal_noise(now.image, now.squared_error, now.surface, before.squared_error, before.surface);
    noise.temporal_error += temporal.rel_mse / (frames - 1);
  }
}

}  // namespace

std::optional<Comparison> compare(const Scene& scene, const ComparisonOptions& options, const std::stop_token& stop,
                                  const ComparisonProgress& progress) {
  return Comparing(scene, options, stop, progress).run();
}

double frame_ms(const Repetition& repetition) {
  return repetition.frames > 0 ? 1000 * repetition.time_s / repetition.frames : 0;
}

std::vector<double> values_of(const ContenderResult& contender, const Figure& figure) {
  std::vector<double> values;
  for (const Repetition& repetition : contender.repetitions) values.push_back(figure(repetition));
  return values;
}

double median_of(const ContenderResult& contender, const Figure& figure) {
  return median(values_of(contender, figure));
}

uint64_t most_nonfinite(const ContenderResult& contender) {
  uint64_t most = 0;
  for (const Repetition& repetition : contender.repetitions) most = std::max(most, repetition.nonfinite);
  return most;
}

std::vector<std::pair<std::string, double>> median_pass_ms(const ContenderResult& contender) {
  std::vector<std::pair<std::string, double>> result;
  for (const PassTime& pass : contender.repetitions.front().passes) {
    std::vector<double> ms;
    for (const Repetition& repetition : contender.repetitions) {
      for (const PassTime& other : repetition.passes) {
        if (other.name == pass.name) ms.push_back(1000 * other.seconds / repetition.frames);
      }
    }
    result.emplace_back(pass.name, median(std::move(ms)));
  }
  return result;
}

}  // namespace relume

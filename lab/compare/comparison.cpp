#include "compare/comparison.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "compare/comparing.h"
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

}  // namespace

Comparing::Comparing(const Scene& scene, const ComparisonOptions& options, const std::stop_token& stop,
                     const ComparisonProgress& progress, SharedWork* shared)
    : scene_(scene), stop_(stop), progress_(progress), shared_(shared) {
  result_.options = options;
  if (shared) result_.ranks = shared->ranks();
  result_.scene_hash = scene_hash(scene);
  result_.triangles = placed_triangles(scene);
}

std::optional<Comparison> Comparing::run() {
  prepare();
  const bool done = shared_ ? share_references() && share_contenders() : make_references() && measure_contenders();
  if (!done || (shared_ && !shared_->is_first() && !options().on_all_ranks)) return std::nullopt;
  measure_images();
  judge_references();
  result_.reference = std::move(references_.back());
  result_.notes = limits_of(result_);
  return std::move(result_);
}

std::function<void(double)> Comparing::stage(std::string name) const {
  return [this, name = std::move(name)](double fraction) {
    if (progress_) progress_(name, fraction);
  };
}

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
  ensembles_.resize(settings_.size());
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

std::vector<float> Comparing::reference_times() const {
  const std::vector<float>& times = options().times_s;
  return times.empty() ? std::vector<float>{result_.reference_settings.render.time_s} : times;
}

ReferenceRenderer Comparing::reference_renderer() const {
  const ComparisonOptions& o = options();
  return {scene_, result_.reference_settings.render, o.reference_spp, o.cache_folder, o.program};
}

bool Comparing::make_references() {
  if (!references_.empty()) return true;
  ReferenceRenderer renderer = reference_renderer();
  const std::vector<float> times = reference_times();
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

/// Builds the sessions of `count` contenders; fewer if a stop was requested.
Sessions Comparing::sessions_of(size_t first, size_t count, const std::stop_token& stop) const {
  Sessions sessions;
  for (size_t i = first; i < first + count && !stop.stop_requested(); ++i) {
    sessions.push_back(std::make_unique<TimedSession>(scene_, settings_[i].render, options().clock));
    sessions.back()->session().shorten_preparation_on(stop);
  }
  return sessions;
}

void Comparing::add_repetition(size_t contender, Repetition repetition, Image image) {
  ContenderResult& result = result_.contenders[contender];
  ensembles_[contender].add(image);
  result.repetitions.push_back(std::move(repetition));
  if (result.repetitions.size() == 1) result.image = image;
  if (options().keep_images) result.images.push_back(std::move(image));
}

void Comparing::split_errors() {
  const Reference& last = references_.back();
  for (size_t i = 0; i < ensembles_.size() && options().repetitions > 1; ++i)
    result_.contenders[i].split = ensembles_[i].split(last.image, last.mse);
}

bool Comparing::measure_contenders() {
  const ComparisonOptions& o = options();
  const Sessions sessions = sessions_of(0, settings_.size(), stop_);
  if (sessions.size() < settings_.size()) return false;
  if (!sessions.empty()) result_.threads = sessions.front()->session().statistics().threads;
  FramePlan plan{.frames = {}, .samples = static_cast<double>(o.spp)};
  if (o.budget_s > 0 && !sessions.empty()) {
    const std::optional<EqualTime> equal = plan_equal_time(sessions, o.times_s, o.budget_s, stop_, stage("timing"));
    if (!equal) return false;
    plan.frames = equal->frames;
    result_.budget_spread = equal->spread();
  }
  const auto progress = stage("contenders");
  for (int repetition = 0; repetition < o.repetitions && !sessions.empty(); ++repetition) {
    std::vector<Repetition> results;
    std::vector<Image> images;
    const bool done = run_repetition(
        sessions, o, plan, references_, repetition, stop_, results, images,
        [&](double fraction) { progress((repetition + fraction) / static_cast<double>(o.repetitions)); });
    if (!done) return false;
    for (size_t i = 0; i < sessions.size(); ++i) add_repetition(i, std::move(results[i]), std::move(images[i]));
  }
  split_errors();
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

std::optional<Comparison> compare(const Scene& scene, const ComparisonOptions& options, const std::stop_token& stop,
                                  const ComparisonProgress& progress, SharedWork* shared) {
  return Comparing(scene, options, stop, progress, shared).run();
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

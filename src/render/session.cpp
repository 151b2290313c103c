#include "render/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "backend/launch.h"
#include "core/error.h"
#include "render/checkpoint.h"
#include "scene/compiled_scene.h"
#include "scene/scene_hash.h"
#include "techniques/accumulate/accumulate.h"
#include "techniques/path/path.h"
#include "techniques/primary_hits/primary_hits.h"

namespace relume {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void add_buffers(BufferTable& table) {
  table.add({"primary-hits", BufferType::hit, "what the camera ray of this frame met"});
  table.add({"radiance", BufferType::rgb32f, "radiance of this frame's sample"});
  table.add({"sum", BufferType::rgb32f, "sum of all samples", true, ResetOn::any_change});
  table.add({"sum-squares", BufferType::f32, "sum of squared luminance", true, ResetOn::any_change});
  table.add({"rays", BufferType::u32, "rays traced for the pixel", true, ResetOn::any_change});
  table.add({"nonfinite", BufferType::u32, "samples that were not finite", true, ResetOn::any_change});
}

void add_auxiliary_buffers(BufferTable& table) {
  if (table.find("albedo")) return;
  table.add({"albedo", BufferType::rgb32f, "directional albedo of the first hit", true, ResetOn::any_change});
  table.add({"normal", BufferType::rgb32f, "shading normal of the first hit", true, ResetOn::any_change});
  table.add({"depth", BufferType::f32, "distance of the first hit, metres", true, ResetOn::any_change});
  table.add({"motion", BufferType::vec2f, "motion since the previous frame, pixels", true, ResetOn::any_change});
}

}  // namespace

struct Session::State {
  State(Scene source, const RenderSettings& s)
      : settings(s),
        hash(relume::scene_hash(source)),
        backend(s.threads),
        buffers(static_cast<uint32_t>(s.width), static_cast<uint32_t>(s.height)) {
    const auto start = Clock::now();
    backend.run("build", [&] {
      scene = std::make_unique<CompiledScene>(std::move(source), settings.camera, settings.time_s, settings.width, settings.height);
    });
    add_buffers(buffers);
    if (settings.auxiliary) add_auxiliary_buffers(buffers);
    prepare_lights();
    statistics.build_s = seconds_since(start);
    statistics.threads = backend.threads();
  }

  void prepare_lights() {
    const LightsView& lights = scene->view().lights;
    power_entries = build_power_lights(lights);
    selector.kind = static_cast<LightSelectorKind>(settings.lights);
    selector.uniform = make_uniform_lights(lights);
    selector.power = {{view_of(power_entries)}};
  }

  SampleIndex sample_index() const {
    return {static_cast<uint32_t>(settings.seed), samples, samples, false};
  }

  PathKernel path_kernel() const {
    PathKernel kernel;
    kernel.context.scene = scene->view();
    kernel.context.selector = selector;
    kernel.context.max_bounces = static_cast<uint32_t>(settings.path.max_bounces);
    kernel.context.russian_roulette = settings.path.russian_roulette;
    kernel.index = sample_index();
    kernel.hits = view<const Hit>("primary-hits");
    kernel.radiance = view<Rgb>("radiance");
    kernel.rays = view<uint32_t>("rays");
    kernel.nonfinite = view<uint32_t>("nonfinite");
    kernel.width = buffers.width();
    return kernel;
  }

  AuxiliaryKernel auxiliary_kernel() const {
    return {scene->view(),     sample_index(),       view<const Hit>("primary-hits"), view<Rgb>("albedo"),
            view<Rgb>("normal"), view<float>("depth"), view<Vec2>("motion"),            buffers.width()};
  }

  template <typename T>
  View<T> view(std::string_view name) const {
    const Buffer* buffer = buffers.find(name);
    return buffer ? buffer->view<T>() : View<T>{};
  }

  RenderSettings settings;
  uint64_t hash;
  Backend backend;
  std::unique_ptr<CompiledScene> scene;
  BufferTable buffers;
  std::vector<AliasEntry> power_entries;
  LightSelector selector;
  uint32_t samples = 0;
  mutable Statistics statistics;
};

Session::Session(Scene scene, const RenderSettings& settings) {
  if (settings.width < 1 || settings.height < 1) {
    throw Error(fmt::format("an image of {}x{} pixels cannot be rendered; --width and --height must be at least 1", settings.width, settings.height));
  }
  state_ = std::make_unique<State>(std::move(scene), settings);
}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

bool Session::render_frame(std::stop_token stop) {
  State& s = *state_;
  const auto start = Clock::now();
  const uint32_t w = s.buffers.width();
  const uint32_t h = s.buffers.height();
  const PrimaryHitsKernel primary{s.scene->view().accel, s.scene->view().camera, s.sample_index(), s.view<Hit>("primary-hits"), w};
  const bool complete = launch(s.backend, "gbuffer", primary, w, h, stop) && launch(s.backend, "trace", s.path_kernel(), w, h, stop);
  if (complete) {
    if (s.settings.auxiliary) launch(s.backend, "auxiliary", s.auxiliary_kernel(), w, h);
    const AccumulateKernel accumulate{s.view<const Rgb>("radiance"), s.view<Rgb>("sum"), s.view<float>("sum-squares"), w};
    launch(s.backend, "accumulate", accumulate, w, h);
    ++s.samples;
  }
  s.statistics.render_s += seconds_since(start);
  return complete;
}

uint32_t Session::sample_count() const { return state_->samples; }

void Session::set_time(float time_s) {
  state_->settings.time_s = time_s;
  state_->scene->set_time(time_s);
  state_->prepare_lights();
  state_->buffers.reset();
  state_->samples = 0;
}

Image Session::image() const {
  const State& s = *state_;
  Image image(static_cast<int>(s.buffers.width()), static_cast<int>(s.buffers.height()));
  const View<const Rgb> sum = s.view<const Rgb>("sum");
  const float scale = s.samples > 0 ? 1.0f / static_cast<float>(s.samples) : 0.0f;
  std::transform(sum.begin(), sum.end(), image.pixels.begin(), [&](const Rgb& v) { return v * scale; });
  return image;
}

double Session::estimated_error() const {
  const State& s = *state_;
  if (s.samples < 2) return std::numeric_limits<double>::infinity();
  const View<const Rgb> sum = s.view<const Rgb>("sum");
  const View<const float> squares = s.view<const float>("sum-squares");
  double variance = 0;
  double mean = 0;
  for (uint32_t i = 0; i < sum.size; ++i) {
    variance += variance_of_mean(sum[i], squares[i], s.samples);
    mean += luminance(sum[i]) / static_cast<float>(s.samples);
  }
  if (mean <= 0) return 0;
  return std::sqrt(variance / sum.size) / (mean / sum.size);
}

const Statistics& Session::statistics() const {
  State& s = *state_;
  const uint64_t pixels = uint64_t{s.buffers.width()} * s.buffers.height();
  s.statistics.samples = pixels * s.samples;
  s.statistics.paths = s.statistics.samples;
  s.statistics.rays = 0;
  s.statistics.nonfinite_samples = 0;
  for (const uint32_t n : s.view<const uint32_t>("rays")) s.statistics.rays += n;
  for (const uint32_t n : s.view<const uint32_t>("nonfinite")) s.statistics.nonfinite_samples += n;
  s.statistics.passes.clear();
  for (const LaunchTime& t : s.backend.times()) s.statistics.passes.push_back({t.name, t.seconds});
  return s.statistics;
}

const RenderSettings& Session::settings() const { return state_->settings; }
const std::vector<std::string>& Session::notes() const { return state_->scene->notes(); }
uint64_t Session::scene_hash() const { return state_->hash; }
const BufferTable& Session::buffers() const { return state_->buffers; }

const std::vector<std::string>& Session::aov_names() {
  static const std::vector<std::string> names{"albedo", "normal", "depth", "motion", "variance", "heatmap"};
  return names;
}

std::vector<ExrChannel> Session::aov(const std::string& name) const {
  const State& s = *state_;
  const size_t count = size_t{s.buffers.width()} * s.buffers.height();
  const float scale = s.samples > 0 ? 1.0f / static_cast<float>(s.samples) : 0.0f;
  const auto plane = [&](const std::string& channel, auto&& value) {
    ExrChannel c{channel, std::vector<float>(count)};
    for (size_t i = 0; i < count; ++i) c.values[i] = value(static_cast<uint32_t>(i));
    return c;
  };
  if (name == "variance") {
    const auto sum = s.view<const Rgb>("sum");
    const auto squares = s.view<const float>("sum-squares");
    return {plane("variance.Y", [&](uint32_t i) { return variance_of_mean(sum[i], squares[i], s.samples); })};
  }
  if (name == "heatmap") {
    const auto rays = s.view<const uint32_t>("rays");
    return {plane("heatmap.Y", [&](uint32_t i) { return static_cast<float>(rays[i]) * scale; })};
  }
  if (std::find(aov_names().begin(), aov_names().end(), name) == aov_names().end()) {
    throw Error(fmt::format("there is no AOV '{}'; known are {}", name, fmt::join(aov_names(), ", ")));
  }
  if (!s.settings.auxiliary) throw Error(fmt::format("AOV '{}' was not recorded; ask for it before rendering starts", name));
  if (name == "depth") {
    const auto depth = s.view<const float>("depth");
    return {plane("depth.Z", [&](uint32_t i) { return depth[i] * scale; })};
  }
  if (name == "motion") {
    const auto motion = s.view<const Vec2>("motion");
    return {plane("motion.X", [&](uint32_t i) { return motion[i].x * scale; }), plane("motion.Y", [&](uint32_t i) { return motion[i].y * scale; })};
  }
  const auto rgb = s.view<const Rgb>(name);
  const bool is_vector = name == "normal";
  std::vector<ExrChannel> channels;
  for (int c = 0; c < 3; ++c) {
    channels.push_back(plane(name + "." + (is_vector ? "XYZ" : "RGB")[c], [&](uint32_t i) { return rgb[i][c] * scale; }));
  }
  return channels;
}

void Session::save_checkpoint(const std::filesystem::path& file) const {
  write_checkpoint(file, {state_->hash, checkpoint_key(state_->settings), state_->samples}, state_->buffers);
}

void Session::load_checkpoint(const std::filesystem::path& file) {
  state_->samples = read_checkpoint(file, {state_->hash, checkpoint_key(state_->settings), 0}, state_->buffers);
}

}  // namespace relume

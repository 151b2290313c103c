#include "render/session.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "core/clock.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "frame/launch.h"
#include "render/aov.h"
#include "render/build_pipeline.h"
#include "render/checkpoint.h"
#include "sampling/blue_noise.h"
#include "sampling/sample_schedule.h"
#include "scene/scene_hash.h"
#include "techniques/temporal/accumulate/accumulate_pass.h"
#include "techniques/temporal/adaptive_sampling/adaptive_sampling_pass.h"

namespace relume {
namespace {

/// Sum over all threads; integers, so that their order does not matter.
uint64_t sum(View<const uint32_t> values) {
  constexpr uint32_t kPart = 65536;
  std::vector<uint64_t> parts((uint64_t{values.size} + kPart - 1) / kPart, 0);
  parallel_for(parts.size(), [&](size_t part) {
    const uint64_t begin = part * kPart;
    const uint64_t end = std::min<uint64_t>(begin + kPart, values.size);
    for (uint64_t i = begin; i < end; ++i) parts[part] += values[static_cast<uint32_t>(i)];
  });
  return std::accumulate(parts.begin(), parts.end(), uint64_t{0});
}

/// Whether two plans have the same passes with the same buffers.
bool same_plan(const std::vector<PassDeclaration>& a, const std::vector<PassDeclaration>& b) {
  const auto same_buffers = [](const BufferDescription& x, const BufferDescription& y) {
    return x.id == y.id && x.reset == y.reset;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const PassDeclaration& x, const PassDeclaration& y) {
    return x.name == y.name && x.reads == y.reads && x.writes == y.writes && x.reads_if_any == y.reads_if_any &&
           x.writes_if_any == y.writes_if_any &&
           std::equal(x.owns.begin(), x.owns.end(), y.owns.begin(), y.owns.end(), same_buffers);
  });
}

void check_size(const RenderSettings& settings) {
  if (settings.width >= 1 && settings.height >= 1) return;
  throw Error(fmt::format("an image of {}x{} pixels cannot be rendered; --width and --height must be at least 1",
                          settings.width, settings.height));
}

}  // namespace

std::vector<PassTime> pass_times_since(std::vector<PassTime> now, const std::vector<PassTime>& before) {
  for (PassTime& pass : now) {
    const auto old = std::find_if(before.begin(), before.end(), [&](const PassTime& b) { return b.name == pass.name; });
    if (old != before.end()) pass.seconds -= old->seconds;
  }
  return now;
}

struct Session::State {
  State(Scene source, const RenderSettings& s, std::vector<Index> movable)
      : settings(s), hash(relume::scene_hash(source)), backend(std::make_unique<Backend>(s.threads)) {
    const double start_s = now_s();
    rebuild_pipeline();
    backend->run("build", [&] {
      scene = std::make_unique<CompiledScene>(
          std::move(source), CompileOptions{settings.camera, settings.time_s, settings.width, settings.height,
                                            settings.texture_filter, std::move(movable)});
    });
    counters.time_s = counters.previous_time_s = settings.time_s;
    statistics.build_s = now_s() - start_s;
  }

  /// Buffers and passes for the settings, both empty.
  void rebuild_pipeline() { take(empty_pipeline()); }

  struct Fresh {
    std::unique_ptr<BufferTable> buffers;
    FramePasses passes;
  };
  Fresh empty_pipeline() const {
    Fresh fresh{
        std::make_unique<BufferTable>(static_cast<uint32_t>(settings.width), static_cast<uint32_t>(settings.height)),
        build_passes(settings)};
    fresh.passes.pipeline.add_buffers(*fresh.buffers);
    return fresh;
  }
  void take(Fresh fresh) {
    buffers = std::move(fresh.buffers);
    passes = std::move(fresh.passes);
  }

  /// Takes pending changes on: what they make invalid is cleared, and where no history survives them, new sequences of
  /// samples begin.
  void apply_changes() {
    if (changes != Change::none) {
      buffers->reset(changes);
      counters.since_change = 0;
    }
    if (includes(changes, ends_sequences(settings))) {
      if (edited && counters.sequence_age > 0) ++counters.epoch;
      counters.sequence_age = 0;
    }
    edited = false;
    if (counters.sequence_age == 0) counters.stretch_time_s = counters.time_s;
  }

  void edit(Change change) {
    changes |= change;
    edited = edited || change != Change::none;
  }

  /// Seed of the sequences. Each time of the animation at which they start has numbers of its own, whichever frames
  /// came before.
  uint32_t scramble() const {
    const auto seed = static_cast<uint32_t>(settings.seed);
    if (counters.epoch == 0 && counters.stretch_time_s == 0.0f) return seed;
    return relume::hash(relume::hash(seed, counters.epoch), float_bits(counters.stretch_time_s));
  }

  SampleIndex sample_index(const SampleSchedule& schedule) const {
    SampleIndex index{.seed = scramble(),
                      .sequence = counters.frames,
                      .frame = counters.frames,
                      .age = counters.sequence_age,
                      .width = buffers->width(),
                      .tile = settings.dither ? blue_noise_tile() : View<const uint16_t>{}};
    if (!settings.stratify) return index;  // a sequence of one element in each frame
    index.sample = schedule.sample(counters.sequence_age, counters.since_change);
    index.sequence = schedule.sequence(counters.sequence_age, counters.since_change, counters.frames);
    index.taken = buffers->view(kSequenceSamples);
    index.camera_runs = schedule.longest_epoch > 0;
    return index;
  }

  FrameContext frame(const std::stop_token& stop) {
    const SampleSchedule schedule{passes.pipeline.longest_epoch(), pilot_samples(settings)};
    const SampleIndex index = sample_index(schedule);
    const bool own_sequence = index.sample >= counters.since_change && index.taken.empty();
    return FrameContext(scene->view(), *buffers, *backend,
                        {.index = index,
                         .number = counters.frames,
                         .since_change = counters.since_change,
                         .changes = changes,
                         .begins_picture = counters.since_change == 0 || counters.picture_frames == counters.frames,
                         .begins_epoch = schedule.begins_epoch(counters.since_change),
                         .stratified = settings.stratify && own_sequence && passes.pipeline.keeps_to_pixels(),
                         .stop = passes.pipeline.keeps_state() ? std::stop_token{} : stop,
                         .hurry = hurry});
  }

  void count_frame() {
    const View<const uint32_t> allocation = buffers->view(kAllocation);
    counters.paths += allocation.empty() ? uint64_t{buffers->width()} * buffers->height() : sum(allocation);
    counters.rays += sum(buffers->view(kRays));
    ++counters.frames;
    ++counters.since_change;
    ++counters.sequence_age;
  }

  RenderSettings settings;
  uint64_t hash;
  std::unique_ptr<Backend> backend;
  std::unique_ptr<BufferTable> buffers;
  FramePasses passes;
  std::unique_ptr<CompiledScene> scene;
  Change changes = Change::none;
  bool edited = false;  ///< some of them are not the animation's
  Counters counters;
  std::stop_token hurry;
  mutable Statistics statistics;
  double picture_begun_s = 0;  ///< statistics.render_s when the picture began
};

Session::Session(Scene scene, const RenderSettings& settings, std::vector<Index> movable) {
  check_size(settings);
  state_ = std::make_unique<State>(std::move(scene), settings, std::move(movable));
}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

bool Session::render_frame(std::stop_token stop) {
  State& s = *state_;
  const double start_s = now_s();
  s.apply_changes();
  s.buffers->swap();
  bool complete = false;
  try {
    complete = s.passes.pipeline.run(s.frame(stop));
  } catch (...) {
    // Passes before the one that failed have added to the picture: what there is of it is not the mean of its samples.
    s.buffers->swap();
    s.edit(Change::settings);
    throw;
  }
  if (complete) {
    s.count_frame();
    s.scene->end_frame();
    s.changes = Change::none;
    s.counters.previous_time_s = s.counters.time_s;
  } else {
    s.buffers->swap();
  }
  s.statistics.render_s += now_s() - start_s;
  return complete;
}

void Session::shorten_preparation_on(std::stop_token token) { state_->hurry = std::move(token); }
bool Session::prepared() const { return state_->passes.pipeline.prepared(); }

uint32_t Session::frames_since_change() const {
  return state_->changes == Change::none ? state_->counters.since_change : 0;
}

double Session::kept_samples() const {
  const View<const uint32_t> samples = state_->buffers->view(kSamples);
  return static_cast<double>(sum(samples)) / std::max(samples.size, 1u);
}

void Session::begin_picture() {
  Counters& c = state_->counters;
  c.picture_frames = c.frames;
  c.picture_paths = c.paths;
  state_->picture_begun_s = state_->statistics.render_s;
}

uint32_t Session::picture_frames() const { return state_->counters.frames - state_->counters.picture_frames; }

double Session::picture_samples() const {
  const Counters& c = state_->counters;
  const double pixels = double{1} * state_->buffers->width() * state_->buffers->height();
  return static_cast<double>(c.paths - c.picture_paths) / pixels;
}

double Session::picture_render_s() const { return state_->statistics.render_s - state_->picture_begun_s; }

void Session::set_time(float time_s) {
  state_->changes |= state_->scene->set_time(time_s);  // before the rest: it may refuse
  state_->settings.time_s = state_->counters.time_s = time_s;
}

void Session::set_camera(const std::optional<PlacedCamera>& camera) { state_->edit(state_->scene->set_camera(camera)); }
void Session::set_transform(Index node, const Transform& transform) {
  state_->edit(state_->scene->set_transform(node, transform));
}
void Session::set_light(Index light, const PunctualLight& value) {
  state_->edit(state_->scene->set_light(light, value));
}
void Session::set_environment(const Environment& environment) {
  state_->edit(state_->scene->set_environment(environment));
}
void Session::set_material(Index material, const Material& value) {
  state_->edit(state_->scene->set_material(material, value));
}

Image Session::image() const {
  const BufferTable& buffers = *state_->buffers;
  Image image(static_cast<int>(buffers.width()), static_cast<int>(buffers.height()));
  const View<const Rgb> denoised = buffers.view(kDenoised);
  const View<const Rgb> mean = denoised.empty() ? buffers.view(kMean) : denoised;
  if (frames_since_change() > 0) std::copy(mean.begin(), mean.end(), image.pixels.begin());
  return image;
}

double Session::estimated_error() const {
  const uint32_t pilot = pilot_samples(state_->settings);
  if (pilot > 0 && state_->counters.since_change <= pilot)
    return std::numeric_limits<double>::infinity();  // what there is by now will be left out
  const BufferTable& buffers = *state_->buffers;
  return relative_error(buffers.view(kMean), buffers.view(kM2), buffers.view(kSamples),
                        {buffers.view(kLightM2), buffers.view(kLightPaths), buffers.view(kLightFrames)});
}

const Statistics& Session::statistics() const {
  State& s = *state_;
  s.statistics.frames = s.counters.frames;
  s.statistics.samples = s.statistics.paths = s.counters.paths;
  s.statistics.rays = s.counters.rays;
  s.statistics.nonfinite_samples = sum(s.buffers->view(kNonfinite));
  s.statistics.scene_bytes = s.scene->memory_bytes();
  s.statistics.buffer_bytes = s.buffers->memory_bytes();
  s.statistics.technique_bytes = s.passes.pipeline.memory_bytes();
  s.statistics.threads = s.backend->threads();
  s.statistics.passes.clear();
  for (const LaunchTime& t : s.backend->times()) s.statistics.passes.push_back({t.name, t.seconds});
  s.statistics.figures = s.passes.pipeline.figures();
  return s.statistics;
}

const RenderSettings& Session::settings() const { return state_->settings; }
const std::vector<std::string>& Session::notes() const { return state_->scene->notes(); }
std::vector<std::string> Session::warnings() const { return state_->passes.pipeline.warnings(); }
uint64_t Session::scene_hash() const { return state_->hash; }
const CompiledScene& Session::scene() const { return *state_->scene; }
const BufferTable& Session::buffers() const { return *state_->buffers; }
std::vector<PassDeclaration> Session::passes() const { return state_->passes.pipeline.declarations(); }

std::vector<std::string> Session::aov_names(const RenderSettings& settings) {
  return names_of(aov_layers(plan(settings)));
}

std::vector<ExrChannel> Session::aov(const std::string& name) const {
  return aov_planes(*state_->buffers, name, state_->counters.since_change);
}

bool Session::set_settings(const RenderSettings& wanted) {
  State& s = *state_;
  RenderSettings settings = wanted;
  RenderSettings& current = s.settings;
  if (settings.texture_filter != current.texture_filter || settings.camera != current.camera) return false;
  check_size(settings);
  // Throws for what does not combine, before anything changes.
  const bool same_passes = same_plan(plan(settings), plan(current));
  SettingList slots = describe_slots(settings);
  const bool same_slots = differing_settings(describe_slots(current), slots).empty();
  const bool resized = settings.width != current.width || settings.height != current.height;
  Change change = Change::none;
  const SettingList before = describe(current);  // the result points into it
  for (const Setting* setting : differing_settings(before, describe(settings))) {
    if (setting->traits.resets_history) change = Change::settings;
  }
  if (settings.time_s != current.time_s) set_time(settings.time_s);  // before anything changes: it may refuse
  s.edit(change);
  if (settings.threads != current.threads) s.backend = std::make_unique<Backend>(settings.threads);
  current = settings;
  if (resized) s.scene->set_resolution(settings.width, settings.height);
  if (resized || !same_slots || !same_passes) {
    s.rebuild_pipeline();
    s.edit(Change::settings);  // its buffers are empty, whether a described setting asked for that or `auxiliary`
  } else {
    configure(s.passes, current);
  }
  return true;
}

void Session::restart(int seed) {
  State& s = *state_;
  s.settings.seed = seed;
  s.rebuild_pipeline();
  s.scene->end_frame();
  s.counters = {};
  s.picture_begun_s = s.statistics.render_s;
  s.counters.time_s = s.counters.previous_time_s = s.settings.time_s;
  s.changes = Change::none;
  s.edited = false;
}

void Session::save_checkpoint(const std::filesystem::path& file) const {
  write_checkpoint(file, {state_->hash, checkpoint_key(state_->settings), state_->counters}, *state_->buffers,
                   state_->passes.pipeline);
}

void Session::load_checkpoint(const std::filesystem::path& file) {
  State& s = *state_;
  // Into passes that have not run: others remember the scene at the time that they were run for.
  State::Fresh fresh = s.empty_pipeline();
  const Counters counters =
      read_checkpoint(file, {s.hash, checkpoint_key(s.settings), {}}, *fresh.buffers, fresh.passes.pipeline);
  s.scene->set_time(counters.previous_time_s);  // before the rest: it may refuse
  s.counters = counters;
  s.take(std::move(fresh));
  s.picture_begun_s = s.statistics.render_s;
  s.scene->end_frame();
  set_time(s.counters.time_s);
  if (s.counters.time_s == s.counters.previous_time_s) s.changes = Change::none;
  s.edited = false;
}

}  // namespace relume

#include "techniques/transport/bdpt/bdpt_pass.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/stream_io.h"
#include "frame/primitives/fill.h"
#include "frame/primitives/reduce.h"
#include "techniques/transport/bdpt/first_light_kernel.h"
#include "techniques/transport/bdpt/light_medium.h"

namespace relume {
namespace {

constexpr BufferKey<FixedPointRgb> kSplats{"splats"};
constexpr BufferKey<FixedPointRgb> kSplatDifferences{"splat-differences"};
constexpr BufferKey<uint64_t> kChosenDirections{"chosen-directions"};
constexpr BufferKey<uint64_t> kChosenSplatDirections{"chosen-splat-directions"};

/// Limit of the memory for light subpaths of one launch, except that of a single row.
constexpr uint64_t kLightVertexBytes = uint64_t{256} << 20;

}  // namespace

PassDeclaration BdptPass::declaration() const {
  std::vector<BufferDescription> owns = estimator_buffers();
  owns.push_back({.id = kSplats, .help = "radiance that light subpaths added to the pixel in the current frame"});
  if (records_.splats) {
    owns.push_back(
        {.id = kLightRadiance, .help = "radiance of this frame's light paths", .display = BufferDisplay::value});
  }
  if (records_.caustics) {
    owns.push_back({.id = kSplatDifferences, .help = "splats, those of half of the light subpaths negative"});
    owns.push_back({.id = kCausticRadiance, .help = "part of this frame's radiance in the caustic layer"});
    owns.push_back({.id = kCausticDifference,
                    .help = "difference of the halves of the light paths in this frame's caustic layer"});
  }
  if (records_.first_vertices) {
    owns.push_back(first_vertices_buffer());
    owns.push_back({.id = kChosenDirections, .help = "direction of one contribution to the pixel, and its key"});
    if (records_.splats_apart)
      owns.push_back({.id = kChosenSplatDirections, .help = "direction of one splat in the pixel, and its key"});
  }
  if (records_.first_scatters) owns.push_back(first_scatters_buffer());
  if (records_.indirect_samples) owns.push_back(indirect_samples_buffer());
  return {.name = "trace",
          .stage = Stage::trace,
          .owns = std::move(owns),
          .reads = {kPrimaryHits},
          .reads_if_any = {kAllocation},
          .only_sampled_pixels = true};
}

void BdptPass::prepare_lights(const FrameContext& frame) {
  if (prepared_ && !includes(frame.changes, kRebuildsLights)) return;
  prepared_ = true;
  const LightsAtInfinity infinity =
      mode_ == BdptMode::light_only ? LightsAtInfinity::all : LightsAtInfinity::worth_sampling;
  frame.backend.run("lights", [&] {
    emission_.assign(build_power_lights(frame.scene.lights, infinity));
    connection_.assign(build_power_lights(frame.scene.lights, selection_.infinity()));
  });
  light_medium_.reset(frame.scene.absorbs ? frame.scene.lights.lights.size : 0, kUninitialized);
  const LightMediumKernel medium{frame.scene, light_medium_.mutable_view()};
  launch(frame.backend, "lights", medium, static_cast<uint32_t>(light_medium_.size()), 1);
}

uint64_t BdptPass::prepare_subpaths(const FrameContext& frame, uint64_t samples, BdptKernel& kernel) {
  if (!frame.backend.has_device() && frame.backend.form() == KernelForm::host) return samples;
  const uint64_t row = uint64_t{kernel.context.max_kept_vertices()} * frame.width();
  const uint64_t bytes = sizeof(PathVertex) + sizeof(CameraConnection) + (weighs_guide() ? sizeof(GuidedPoint) : 0);
  const uint64_t rows = kLightVertexBytes / std::max<uint64_t>(row * bytes, 1);
  kernel.kept_rows = static_cast<uint32_t>(std::clamp<uint64_t>(rows, 1, frame.height()));
  const size_t elements = row * kernel.kept_rows;
  vertices_.reset(elements, kUninitialized);
  to_camera_.reset(elements, kUninitialized);
  kernel.vertices = vertices_.mutable_view();
  kernel.to_camera = to_camera_.mutable_view();
  guides_.reset(weighs_guide() ? elements : 0, kUninitialized);
  kernel.guides = guides_.mutable_view();
  return samples;
}

LearningContext BdptPass::learning(const BdptContext& context) const {
  LearningContext learning{context};
  if (recording_) learning.recording = *recording_;
  if (records_.chains.guide) learning.chains.guide = *records_.chains.guide;
  if (records_.chains.lights) learning.chains.lights = *records_.chains.lights;
  learning.weighs_guide = weighs_guide();
  return learning;
}

SubpathSamples BdptPass::samples_output(const FrameContext& frame, const BdptKernel& kernel) {
  return {kernel.output.radiance, {frame.write(kIndirectSamples)}};
}

bool BdptPass::trace(const FrameContext& frame, const BdptKernel& kernel) {
  if (samples_indirect_light()) return trace_into(frame, kernel, samples_output(frame, kernel));
  return trace_into(frame, kernel, kernel.output);
}

CausticViews BdptPass::caustics(const FrameContext& frame) const {
  if (!records_.caustics) return {};
  return {frame.write(kCausticRadiance), frame.write(kCausticDifference)};
}

FirstLight BdptPass::begin_first_light(const FrameContext& frame, float splat_scale) const {
  FirstLight light{.vertices = frame.write(kFirstVertices),
                   .chosen = frame.write(kChosenDirections),
                   .seed = hash(frame.index.seed, frame.index.frame, 0x46564c31u),
                   .splat_scale = splat_scale};
  fill(frame.backend, "splats", light.chosen, uint64_t{0});
  if (!records_.splats_apart) return light;
  light.splats = frame.write(kChosenSplatDirections);
  fill(frame.backend, "splats", light.splats, uint64_t{0});
  return light;
}

bool BdptPass::record_first_vertices(const FrameContext& frame, const BdptKernel& kernel) const {
  const FirstLightKernel record{kernel.context, kernel.index, kernel.hits, kernel.allocation, frame.read(kRadiance)};
  return frame.launch_or_stop("first-vertices", record);
}

bool BdptPass::run(const FrameContext& frame) {
  frame_faults_ = {};
  prepare_lights(frame);
  BdptKernel kernel;
  BdptContext& c = kernel.context;
  c.path = make_path_context(source_, frame);
  c.emission = {{emission_.view()}};
  c.connection = {{connection_.view()}};
  c.light_medium = light_medium_.view();
  c.splats = frame.write(kSplats);
  if (records_.caustics) c.splat_differences = frame.write(kSplatDifferences);
  if (records_.first_scatters) c.first_scatters = frame.write(kFirstScatters);
  c.width = frame.width();
  c.max_light_vertices = static_cast<uint32_t>(settings_.max_light_vertices);
  c.connection_roulette = settings_.connection_roulette;
  c.light_only = mode_ == BdptMode::light_only;
  if (c.light_only) c.path.directions.quadtrees.words = {};  // no camera subpath learns radiance
  kernel.index = frame.index;
  kernel.hits = frame.read(kPrimaryHits);
  kernel.allocation = frame.read(kAllocation);
  kernel.output.radiance = frame.write(kRadiance);
  kernel.rays = frame.write(kRays);
  faults_.write() = {};
  SplatFaults* const faults = faults_.mutable_view().data;
  kernel.saturated = {&faults->saturated, 1};
  kernel.nonfinite = {&faults->nonfinite, 1};

  AddSplatsKernel add{c.splats, kernel.output.radiance, {}, 1.0f, c.width};
  if (records_.splats) add.brought = frame.write(kLightRadiance);
  add.caustics = caustics(frame);
  add.differences = c.splat_differences;
  add.joins_merged = merges();
  uint64_t samples = frame.pixels();
  if (!kernel.allocation.empty()) samples = sum({frame.backend, "splats", scratch_}, kernel.allocation);
  const uint64_t light_paths = prepare_subpaths(frame, samples, kernel);
  c.light_paths /= averaged_subpaths();
  add.scale = light_paths > 0 ? static_cast<float>(frame.pixels()) / static_cast<float>(light_paths) : 0.0f;
  if (records_.first_vertices) c.first_light = begin_first_light(frame, add.scale);
  if (has_splats_) {
    fill(frame.backend, "splats", c.splats, FixedPointRgb{});
    if (records_.caustics) fill(frame.backend, "splats", c.splat_differences, FixedPointRgb{});
  }
  has_splats_ = true;
  if (!trace(frame, kernel) || !frame.launch_or_stop("splats", add)) return false;
  if (records_.first_vertices && !record_first_vertices(frame, kernel)) return false;
  frame_faults_ = faults_.read();
  has_splats_ = false;  // only now: reading waits for the launches, and throws if one has failed
  saturated_ += frame_faults_.saturated;
  nonfinite_ += frame_faults_.nonfinite;
  return true;
}

void BdptPass::abandon() {
  saturated_ -= frame_faults_.saturated;
  nonfinite_ -= frame_faults_.nonfinite;
  frame_faults_ = {};
}

std::vector<std::string> BdptPass::warnings() const {
  std::vector<std::string> result;
  if (saturated_ > 0) {
    result.push_back(
        fmt::format("{} contributions of light paths were brighter than {} and were clamped to it, so some pixels are "
                    "too dark; dim the scene's lights and raise the exposure instead",
                    saturated_, kFixedPointMax));
  }
  if (nonfinite_ > 0) {
    result.push_back(fmt::format(
        "{} contributions of light paths were not finite and are missing; please report the scene", nonfinite_));
  }
  return result;
}

void BdptPass::save(std::ostream& out) const {
  write_value(out, saturated_);
  write_value(out, nonfinite_);
}
void BdptPass::load(std::istream& in) {
  frame_faults_ = {};
  read_value(in, saturated_);
  read_value(in, nonfinite_);
}

}  // namespace relume

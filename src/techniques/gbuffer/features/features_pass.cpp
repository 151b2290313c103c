#include "techniques/gbuffer/features/features_pass.h"

#include <algorithm>
#include <cstring>

#include "techniques/gbuffer/features/picture_history.h"
#include "techniques/gbuffer/primary_hits/primary_hits_pass.h"
#include "techniques/temporal/reprojection/backward_buffers.h"

namespace relume {
namespace {

constexpr BufferKey<Rgb> kUnfiltered{"unfiltered"};
constexpr BufferKey<float> kFilteredShare{"filtered-share"};

BufferDescription kept(const BufferId& id, const char* help) {
  return {.id = id, .help = help, .persistent = true, .display = BufferDisplay::value};
}

/// Where pixels were one frame ago, by their features or by the images in their reflections.
BackwardReprojection feature_reprojection(const FrameContext& frame, LightPart part) {
  return backward_reprojection(frame, part == LightPart::specular ? kReflection : kFeature);
}

/// Samples that histories count for at most in this frame.
uint32_t history_limit(const FrameContext& frame, const DenoiserHistorySettings& settings) {
  if (includes(frame.changes, Change::geometry | Change::lights))
    return static_cast<uint32_t>(settings.max_history_changed);
  return frame.changes == Change::none ? kNoHistoryLimit : static_cast<uint32_t>(settings.max_history);
}

/// Buffers that hold ReflectionViews.
std::vector<BufferDescription> reflection_buffers() {
  return {
      surface_buffer(kDiffuseAlbedo, "the part of feature-albedo that is not specular", false),
      surface_buffer(kSpecularAlbedo, "directional albedo of specular lobes; black: their light is not kept apart",
                     false),
      surface_buffer(kReflection.position,
                     "image in a reflection where it is sharp, else the surface that reflects, metres", true, "XYZ"),
      surface_buffer(kReflection.previous, "where specular-position was one frame ago, metres", false, "XYZ"),
      surface_buffer(kReflection.normal, "normal at specular-position", true, "XYZ"),
      surface_buffer(kReflection.depth, "distance that bounds how far histories may lie off the plane, metres", false,
                     "Z"),
      surface_buffer(kReflection.motion, "motion of the image since the previous frame, pixels", false)};
}

ReflectionViews reflection_views(const FrameContext& frame) {
  return {.diffuse_albedo = frame.write(kDiffuseAlbedo),
          .albedo = frame.write(kSpecularAlbedo),
          .position = frame.write(kReflection.position),
          .previous = frame.write(kReflection.previous),
          .normal = frame.write(kReflection.normal),
          .depth = frame.write(kReflection.depth),
          .motion = frame.write(kReflection.motion)};
}

}  // namespace

PassDeclaration FeaturesPass::declaration() const {
  PassDeclaration declaration{
      .name = "features",
      .stage = Stage::gbuffer,
      .owns = {surface_buffer(kFeature.position, "surface seen, mirrors taken for windows, metres", true, "XYZ"),
               surface_buffer(kFeature.previous, "where it was one frame ago, metres", false, "XYZ"),
               surface_buffer(kFeature.normal, "its shading normal", true, "XYZ"),
               surface_buffer(kFeatureAlbedo, "its directional albedo, and what mirrors take from it", false),
               surface_buffer(kFeatureEmission, "emission seen directly or in mirrors", false),
               surface_buffer(kFeature.depth, "length of the way to it, metres", false, "Z"),
               surface_buffer(kFeature.motion,
                              "its motion since the previous frame, pixels; 65504 where it lay behind its camera",
                              false),
               surface_buffer(kFeature.surface, "a number that tells surfaces apart", true)},
      .reads = {kPrimaryHits}};
  if (!split_) return declaration;
  for (BufferDescription& buffer : reflection_buffers()) declaration.owns.push_back(std::move(buffer));
  return declaration;
}

bool FeaturesPass::run(const FrameContext& frame) {
  FeatureKernel kernel;
  kernel.scene = frame.scene;
  kernel.index = frame.index;
  kernel.hits = frame.read(kPrimaryHits);
  kernel.position = frame.write(kFeature.position);
  kernel.previous = frame.write(kFeature.previous);
  kernel.normal = frame.write(kFeature.normal);
  kernel.albedo = frame.write(kFeatureAlbedo);
  kernel.emission = frame.write(kFeatureEmission);
  kernel.depth = frame.write(kFeature.depth);
  kernel.motion = frame.write(kFeature.motion);
  kernel.surface = frame.write(kFeature.surface);
  if (split_) kernel.reflections = reflection_views(frame);
  kernel.max_steps = followed_steps(max_bounces_, mirrors_);
  kernel.camera_moved = std::memcmp(&frame.scene.camera, &frame.scene.previous_camera, sizeof(CameraView)) != 0;
  kernel.width = frame.width();
  return frame.launch_or_stop("features", kernel);
}

uint32_t followed_steps(int max_bounces, bool mirrors) {
  return mirrors ? std::min(static_cast<uint32_t>(max_bounces), kMaxFeatureSteps) : 0u;
}

BufferDescription denoiser_history(const BufferId& id, const char* help) {
  return {.id = id,
          .help = help,
          .persistent = true,
          .double_buffered = true,
          .reset = kEndsDenoiserHistory,
          .display = BufferDisplay::value};
}

BufferDescription denoised_buffer() { return kept(kDenoised, "the picture, denoised"); }

BufferDescription unfiltered_buffer() {
  BufferDescription buffer =
      kept(kUnfiltered, "mean of what the denoiser does not filter, emission above all, since the last change");
  buffer.double_buffered = true;
  return buffer;
}

BufferDescription filtered_share_buffer() {
  return kept(kFilteredShare, "share of the frames since the last change that the denoiser filtered there");
}

std::vector<BufferId> feature_buffers() {
  return {kRadiance,
          kMean,
          kM2,
          kSamples,
          kFeature.position,
          kFeature.previous,
          kFeature.normal,
          kFeatureAlbedo,
          kFeature.depth,
          kFeature.motion,
          kFeature.surface,
          kEdgeRays,
          kShownEmission,
          kScattered};
}

void add_split_buffers(std::vector<BufferId>& reads) {
  reads.insert(reads.end(),
               {kDiffuseAlbedo, kDiffuseScattered, kSpecularAlbedo, kSpecularScattered, kReflection.position,
                kReflection.previous, kReflection.normal, kReflection.depth, kReflection.motion});
}

void ReflectingFrames::begin_frame(const FrameContext& frame) {
  const View<const Rgb> albedo = frame.read(kSpecularAlbedo);
  before_ = now_;
  now_ = std::any_of(albedo.begin(), albedo.end(), [](const Rgb& a) { return is_filtered(a); });
}

SurfaceLight surface_light(const FrameContext& frame, LightPart part) {
  constexpr BufferKey<Rgb> kPartScattered[] = {kScattered, kDiffuseScattered, kSpecularScattered};
  constexpr BufferKey<Rgb> kPartAlbedo[] = {kFeatureAlbedo, kDiffuseAlbedo, kSpecularAlbedo};
  const auto i = static_cast<size_t>(part);
  return {frame.read(kRadiance), frame.read(kPartScattered[i]), frame.read(kAllocation), frame.read(kPartAlbedo[i]),
          frame.read(kShownEmission)};
}

LightHistory light_history(const FrameContext& frame, const LightHistoryBuffers& buffers,
                           const DenoiserHistorySettings& settings, LightPart part) {
  return {.reprojection = feature_reprojection(frame, part),
          .samples = surface_light(frame, part),
          .light_before = frame.previous(buffers.light),
          .count_before = frame.previous(buffers.samples),
          .light = frame.write(buffers.light),
          .count = frame.write(buffers.samples),
          .max_samples = history_limit(frame, settings),
          .least_share = 0,
          .discounts = {}};
}

bool lacks_history(const FrameContext& frame, const BufferKey<uint32_t>& samples,
                   const BufferKey<uint32_t>& specular_samples) {
  if (frame.number > 0 && frame.changes == Change::none) return false;
  const View<const Rgb> albedo = frame.read(kFeatureAlbedo);
  const View<const uint32_t> known = frame.read(samples);
  const View<const uint32_t> known_specular = specular_samples.name.empty() ? known : frame.read(specular_samples);
  constexpr uint32_t kStride = 61;
  uint32_t filtered = 0;
  uint32_t fresh = 0;
  for (uint32_t i = 0; i < frame.pixels(); i += kStride) {
    if (!is_filtered(albedo[i])) continue;
    ++filtered;
    fresh += std::max(known[i], known_specular[i]) <= 1 ? 1 : 0;
  }
  return 2 * fresh > filtered;
}

void finish_picture(const FrameContext& frame, const PictureBuffers& buffers, float newest) {
  const bool still = frame.changes == Change::none;
  PictureHistoryKernel average;
  average.shown = frame.read(buffers.shown);
  average.before = frame.previous(buffers.history);
  average.motion = frame.read(kFeature.motion);
  average.albedo = frame.read(kFeatureAlbedo);
  average.emission = frame.read(kShownEmission);
  average.edge_rays = frame.read(kEdgeRays);
  average.unfiltered_before = frame.previous(kUnfiltered);
  average.unfiltered = frame.write(kUnfiltered);
  average.filtered_share = frame.write(kFilteredShare);
  average.picture = frame.write(buffers.history);
  if (!buffers.specular.shown.name.empty()) {
    average.specular.shown = frame.read(buffers.specular.shown);
    average.specular.before = frame.previous(buffers.specular.history);
    average.specular.motion = frame.read(kReflection.motion);
    average.specular.picture = frame.write(buffers.specular.history);
  }
  average.still = still;
  average.newest = newest;
  average.frames = frame.since_change + 1;
  const bool changed = includes(frame.changes, Change::materials | Change::settings);
  if (frame.number == 0 || changed || lacks_history(frame, buffers.samples, buffers.specular.samples))
    average.newest = 1.0f;
  average.width = frame.width();
  average.height = frame.height();
  frame.launch(buffers.launch_name, average);

  ConvergeKernel converge;
  converge.picture = frame.read(buffers.history);
  converge.mean = frame.read(kMean);
  converge.m2 = frame.read(kM2);
  converge.samples = frame.read(kSamples);
  converge.converged = frame.write(kDenoised);
  converge.stratified = frame.stratified;
  converge.still = still;
  converge.width = frame.width();
  converge.height = frame.height();
  frame.launch(buffers.launch_name, converge);
}

}  // namespace relume

#include "techniques/features/features_pass.h"

#include <algorithm>
#include <cstring>

#include "techniques/features/picture_history.h"
#include "techniques/primary_hits/primary_hits_pass.h"
#include "techniques/reprojection/backward_buffers.h"

namespace relume {
namespace {

constexpr const char* kUnfiltered = "unfiltered";
constexpr const char* kFilteredShare = "filtered-share";

BufferDescription kept(const char* name, BufferType type, const char* help) {
  return {.name = name, .type = type, .help = help, .persistent = true, .display = BufferDisplay::value};
}

/// Where pixels were one frame ago, by their features or by the images in their reflections.
BackwardReprojection feature_reprojection(const FrameContext& frame, LightPart part) {
  if (part == LightPart::specular) {
    return backward_reprojection(frame, {.motion = "specular-motion",
                                         .previous = "specular-previous",
                                         .position = "specular-position",
                                         .normal = "specular-normal",
                                         .depth = "specular-depth",
                                         .surface = "feature-surface"});
  }
  return backward_reprojection(frame, {.motion = "feature-motion",
                                       .previous = "feature-previous",
                                       .position = "feature-position",
                                       .normal = "feature-normal",
                                       .depth = "feature-depth",
                                       .surface = "feature-surface"});
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
      surface_buffer("diffuse-albedo", BufferType::rgb32f, "the part of feature-albedo that is not specular", false),
      surface_buffer("specular-albedo", BufferType::rgb32f,
                     "directional albedo of specular lobes; black: their light is not kept apart", false),
      surface_buffer("specular-position", BufferType::rgb32f,
                     "image in a reflection where it is sharp, else the surface that reflects, metres", true, "XYZ"),
      surface_buffer("specular-previous", BufferType::rgb32f, "where specular-position was one frame ago, metres",
                     false, "XYZ"),
      surface_buffer("specular-normal", BufferType::rgb32f, "normal at specular-position", true, "XYZ"),
      surface_buffer("specular-depth", BufferType::f32,
                     "distance that bounds how far histories may lie off the plane, metres", false, "Z"),
      surface_buffer("specular-motion", BufferType::vec2f, "motion of the image since the previous frame, pixels",
                     false)};
}

ReflectionViews reflection_views(const FrameContext& frame) {
  return {.diffuse_albedo = frame.view<Rgb>("diffuse-albedo"),
          .albedo = frame.view<Rgb>("specular-albedo"),
          .position = frame.view<Vec3>("specular-position"),
          .previous = frame.view<Vec3>("specular-previous"),
          .normal = frame.view<Vec3>("specular-normal"),
          .depth = frame.view<float>("specular-depth"),
          .motion = frame.view<Vec2>("specular-motion")};
}

}  // namespace

PassDeclaration FeaturesPass::declaration() const {
  PassDeclaration declaration{
      .name = "features",
      .stage = Stage::gbuffer,
      .owns = {surface_buffer("feature-position", BufferType::rgb32f, "surface seen, mirrors taken for windows, metres",
                              true, "XYZ"),
               surface_buffer("feature-previous", BufferType::rgb32f, "where it was one frame ago, metres", false,
                              "XYZ"),
               surface_buffer("feature-normal", BufferType::rgb32f, "its shading normal", true, "XYZ"),
               surface_buffer("feature-albedo", BufferType::rgb32f,
                              "its directional albedo, and what mirrors take from it", false),
               surface_buffer("feature-emission", BufferType::rgb32f, "emission seen directly or in mirrors", false),
               surface_buffer("feature-depth", BufferType::f32, "length of the way to it, metres", false, "Z"),
               surface_buffer("feature-motion", BufferType::vec2f,
                              "its motion since the previous frame, pixels; 65504 where it lay behind its camera",
                              false),
               surface_buffer("feature-surface", BufferType::u32, "a number that tells surfaces apart", true)},
      .reads = {"primary-hits"}};
  if (!split_) return declaration;
  for (BufferDescription& buffer : reflection_buffers()) declaration.owns.push_back(std::move(buffer));
  return declaration;
}

bool FeaturesPass::run(const FrameContext& frame) {
  FeatureKernel kernel;
  kernel.scene = frame.scene;
  kernel.index = frame.index;
  kernel.hits = frame.view<const Hit>("primary-hits");
  kernel.position = frame.view<Vec3>("feature-position");
  kernel.previous = frame.view<Vec3>("feature-previous");
  kernel.normal = frame.view<Vec3>("feature-normal");
  kernel.albedo = frame.view<Rgb>("feature-albedo");
  kernel.emission = frame.view<Rgb>("feature-emission");
  kernel.depth = frame.view<float>("feature-depth");
  kernel.motion = frame.view<Vec2>("feature-motion");
  kernel.surface = frame.view<uint32_t>("feature-surface");
  if (split_) kernel.reflections = reflection_views(frame);
  kernel.max_steps = followed_steps(max_bounces_, mirrors_);
  kernel.camera_moved = std::memcmp(&frame.scene.camera, &frame.scene.previous_camera, sizeof(CameraView)) != 0;
  kernel.width = frame.width();
  return frame.launch("features", kernel);
}

uint32_t followed_steps(int max_bounces, bool mirrors) {
  return mirrors ? std::min(static_cast<uint32_t>(max_bounces), kMaxFeatureSteps) : 0u;
}

BufferDescription denoiser_history(const char* name, BufferType type, const char* help) {
  return {.name = name,
          .type = type,
          .help = help,
          .persistent = true,
          .double_buffered = true,
          .reset = kEndsDenoiserHistory,
          .display = BufferDisplay::value};
}

BufferDescription denoised_buffer() { return kept("denoised", BufferType::rgb32f, "the picture, denoised"); }

BufferDescription unfiltered_buffer() {
  BufferDescription buffer =
      kept(kUnfiltered, BufferType::rgb32f,
           "mean of what the denoiser does not filter, emission above all, since the last change");
  buffer.double_buffered = true;
  return buffer;
}

BufferDescription filtered_share_buffer() {
  return kept(kFilteredShare, BufferType::f32,
              "share of the frames since the last change that the denoiser filtered there");
}

std::vector<std::string_view> feature_buffers() {
  return {"radiance",
          "mean",
          "m2",
          "samples",
          "feature-position",
          "feature-previous",
          "feature-normal",
          "feature-albedo",
          "feature-depth",
          "feature-motion",
          "feature-surface",
          "edge-rays",
          "shown-emission",
          "scattered"};
}

void add_split_buffers(std::vector<std::string_view>& reads) {
  reads.insert(reads.end(),
               {"diffuse-albedo", "diffuse-scattered", "specular-albedo", "specular-scattered", "specular-position",
                "specular-previous", "specular-normal", "specular-depth", "specular-motion"});
}

void ReflectingFrames::begin_frame(const FrameContext& frame) {
  const View<const Rgb> albedo = frame.view<const Rgb>("specular-albedo");
  before_ = now_;
  now_ = std::any_of(albedo.begin(), albedo.end(), [](const Rgb& a) { return is_filtered(a); });
}

SurfaceLight surface_light(const FrameContext& frame, LightPart part) {
  constexpr std::string_view kScattered[] = {"scattered", "diffuse-scattered", "specular-scattered"};
  constexpr std::string_view kAlbedo[] = {"feature-albedo", "diffuse-albedo", "specular-albedo"};
  const auto i = static_cast<size_t>(part);
  return {frame.view<const Rgb>("radiance"), frame.view<const Rgb>(kScattered[i]),
          frame.view<const uint32_t>("allocation"), frame.view<const Rgb>(kAlbedo[i]),
          frame.view<const Rgb>("shown-emission")};
}

LightHistory light_history(const FrameContext& frame, const LightHistoryBuffers& buffers,
                           const DenoiserHistorySettings& settings, LightPart part) {
  return {.reprojection = feature_reprojection(frame, part),
          .samples = surface_light(frame, part),
          .light_before = frame.previous<const Rgb>(buffers.light),
          .count_before = frame.previous<const uint32_t>(buffers.samples),
          .light = frame.view<Rgb>(buffers.light),
          .count = frame.view<uint32_t>(buffers.samples),
          .max_samples = history_limit(frame, settings),
          .least_share = 0,
          .discounts = {}};
}

bool lacks_history(const FrameContext& frame, std::string_view samples, std::string_view specular_samples) {
  if (frame.number > 0 && frame.changes == Change::none) return false;
  const View<const Rgb> albedo = frame.view<const Rgb>("feature-albedo");
  const View<const uint32_t> known = frame.view<const uint32_t>(samples);
  const View<const uint32_t> known_specular =
      specular_samples.empty() ? known : frame.view<const uint32_t>(specular_samples);
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
  average.shown = frame.view<const Rgb>(buffers.shown);
  average.before = frame.previous<const Rgb>(buffers.history);
  average.motion = frame.view<const Vec2>("feature-motion");
  average.albedo = frame.view<const Rgb>("feature-albedo");
  average.emission = frame.view<const Rgb>("shown-emission");
  average.edge_rays = frame.view<const uint32_t>("edge-rays");
  average.unfiltered_before = frame.previous<const Rgb>(kUnfiltered);
  average.unfiltered = frame.view<Rgb>(kUnfiltered);
  average.filtered_share = frame.view<float>(kFilteredShare);
  average.picture = frame.view<Rgb>(buffers.history);
  if (!buffers.specular.shown.empty()) {
    average.specular.shown = frame.view<const Rgb>(buffers.specular.shown);
    average.specular.before = frame.previous<const Rgb>(buffers.specular.history);
    average.specular.motion = frame.view<const Vec2>("specular-motion");
    average.specular.picture = frame.view<Rgb>(buffers.specular.history);
  }
  average.still = still;
  average.newest = newest;
  average.frames = frame.since_change + 1;
  const bool changed = includes(frame.changes, Change::materials | Change::settings);
  if (frame.number == 0 || changed || lacks_history(frame, buffers.samples, buffers.specular.samples))
    average.newest = 1.0f;
  average.width = frame.width();
  average.height = frame.height();
  launch(frame.backend, buffers.launch_name, average, frame.width(), frame.height());

  ConvergeKernel converge;
  converge.picture = frame.view<const Rgb>(buffers.history);
  converge.mean = frame.view<const Rgb>("mean");
  converge.m2 = frame.view<const float>("m2");
  converge.samples = frame.view<const uint32_t>("samples");
  converge.converged = frame.view<Rgb>("denoised");
  converge.stratified = frame.stratified;
  converge.still = still;
  converge.width = frame.width();
  converge.height = frame.height();
  launch(frame.backend, buffers.launch_name, converge, frame.width(), frame.height());
}

}  // namespace relume

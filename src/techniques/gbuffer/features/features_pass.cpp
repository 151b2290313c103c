#include "techniques/gbuffer/features/features_pass.h"

#include <algorithm>

#include "techniques/gbuffer/features/features.h"
#include "techniques/gbuffer/primary_hits/primary_hits_pass.h"

namespace relume {
namespace {

/// The buffers of ReflectionViews.
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
  kernel.camera_moved = !same_view(frame.scene.camera, frame.scene.previous_camera);
  kernel.width = frame.width();
  return frame.launch_or_stop("features", kernel);
}

uint32_t followed_steps(int max_bounces, bool mirrors) {
  return mirrors ? std::min(static_cast<uint32_t>(max_bounces), kMaxFeatureSteps) : 0u;
}

}  // namespace relume

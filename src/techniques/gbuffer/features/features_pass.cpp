#include "techniques/gbuffer/features/features_pass.h"

#include <algorithm>

#include "techniques/gbuffer/features/features.h"
#include "techniques/gbuffer/primary_hits/primary_hits_pass.h"

namespace relume {
namespace {

/// The buffers of ReflectionViews.
std::vector<BufferDescription> reflection_buffers() {
  return {
      surface_buffer(kDiffuseAlbedo, "non-specular part of feature-albedo", false),
      surface_buffer(kSpecularAlbedo,
                     "directional albedo of specular lobes; black where specular light is not separate", false),
      surface_buffer(kReflection.position,
                     "position of the virtual image where it is sharp, else of the reflecting surface, metres", true,
                     "XYZ"),
      surface_buffer(kReflection.previous, "specular-position one frame ago, metres", false, "XYZ"),
      surface_buffer(kReflection.normal, "normal at specular-position", true, "XYZ"),
      surface_buffer(kReflection.depth, "distance that scales the plane tolerance of histories, metres", false, "Z"),
      surface_buffer(kReflection.motion, "motion of the virtual image since the previous frame, pixels", false)};
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

/// Writes the features of surfaces that paths hand over.
class FeaturesPass::FromPaths final : public FirstSurfaces {
 public:
  /// Expects the surfaces of this frame. Returns false if it cannot use them. Only the host form of paths hands them
  /// over. With dispersion, a path sees surfaces at one wavelength. Hooks read complete features after the pass.
  bool expect(const FeatureKernel& kernel, const FrameContext& frame) {
    kernel_ = kernel;
    expected_ = frame.backend.form() == KernelForm::host && !frame.scene.disperses && !frame.observed;
    return expected_;
  }

  bool expected() const override { return expected_; }
  void receive(uint32_t pixel, const Ray& ray, uint32_t ray_id, const Hit& hit,
               const SurfacePoint& surface) const override {
    kernel_.write(pixel, ray, ray_id, hit, surface);
  }

 private:
  FeatureKernel kernel_;
  bool expected_ = false;
};

FeaturesPass::FeaturesPass(const PathSettings& path, bool mirrors, bool split)
    : max_bounces_(path.max_bounces), mirrors_(mirrors), split_(split) {}
FeaturesPass::~FeaturesPass() = default;

const FirstSurfaces& FeaturesPass::from_paths() {
  if (!from_paths_) from_paths_ = std::make_unique<FromPaths>();
  return *from_paths_;
}

PassDeclaration FeaturesPass::declaration() const {
  PassDeclaration declaration{
      .name = "features",
      .stage = Stage::gbuffer,
      .owns = {surface_buffer(kFeature.position, "position of the visible surface, unfolded through mirrors, metres",
                              true, "XYZ"),
               surface_buffer(kFeature.previous, "feature-position one frame ago, metres", false, "XYZ"),
               surface_buffer(kFeature.normal, "shading normal of the visible surface", true, "XYZ"),
               surface_buffer(kFeatureAlbedo,
                              "directional albedo of the visible surface, times the reflectance of mirrors in front",
                              false),
               surface_buffer(kFeatureEmission, "emission visible directly or in mirrors", false),
               surface_buffer(kFeature.depth, "path length to the visible surface, metres", false, "Z"),
               surface_buffer(kFeature.motion,
                              "motion since the previous frame, pixels; 65504 where the surface was behind the camera",
                              false),
               surface_buffer(kFeature.surface, "identifier of the visible surface", true)},
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
  if (from_paths_ && from_paths_->expect(kernel, frame)) return true;
  return frame.launch_or_stop("features", kernel);
}

uint32_t followed_steps(int max_bounces, bool mirrors) {
  return mirrors ? std::min(static_cast<uint32_t>(max_bounces), kMaxFeatureSteps) : 0u;
}

}  // namespace relume

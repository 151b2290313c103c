// Keys of the buffers that several techniques use. The owner's declaration describes each (PassDeclaration::owns).
#pragma once

#include "core/ray.h"
#include "framebuffer/pixel_moments.h"

namespace relume {

// --- This frame's samples -----------------------------------------------------------------------------

inline constexpr BufferKey<uint32_t> kAllocation{"allocation"};             ///< paths per pixel, 0 or 1
inline constexpr BufferKey<uint32_t> kSequenceSamples{"sequence-samples"};  ///< index of a pixel's next sample
inline constexpr BufferKey<Hit> kPrimaryHits{"primary-hits"};
inline constexpr BufferKey<Rgb> kRadiance{"radiance"};
inline constexpr BufferKey<Rgb> kRadianceSpecular{"radiance-specular"};  ///< the part from specular lobes
inline constexpr BufferKey<Rgb> kLightRadiance{"light-radiance"};        ///< the part from light paths
inline constexpr BufferKey<uint32_t> kRays{"rays"};
inline constexpr BufferKey<uint32_t> kEdgeRays{"edge-rays"};

// --- Accumulated samples ------------------------------------------------------------------------------

inline constexpr BufferKey<Rgb> kMean{"mean"};
inline constexpr BufferKey<uint32_t> kSamples{"samples"};

/// The samples that each pixel keeps. AccumulatePass alone writes them: until it runs, they are those of the previous
/// frame, at the previous frame's pixels.
inline constexpr MomentBuffers kMoments{.mean = kMean, .m2 = {"m2"}, .m2_rgb = {"m2-rgb"}, .samples = kSamples};
inline constexpr BufferKey<Rgb> kSpecularMean{"specular-mean"};  ///< the part of kMean from specular lobes
inline constexpr BufferKey<uint32_t> kSpecularSamples{"specular-samples"};

/// The moments that reprojection moved to this frame's pixels, before this frame's sample. They exist only with it.
inline constexpr MomentBuffers kInherited{.mean = {"inherited-mean"},
                                          .m2 = {"inherited-m2"},
                                          .m2_rgb = {"inherited-m2-rgb"},
                                          .samples = {"inherited-samples"}};
inline constexpr BufferKey<Rgb> kInheritedSpecularMean{"inherited-specular-mean"};
inline constexpr BufferKey<uint32_t> kInheritedSpecularSamples{"inherited-specular-samples"};

inline constexpr BufferKey<Rgb> kLightMean{"light-mean"};  ///< of light paths, which reach every pixel
inline constexpr BufferKey<float> kLightM2{"light-m2"};
inline constexpr BufferKey<float> kLightPaths{"light-paths"};
inline constexpr BufferKey<uint32_t> kLightFrames{"light-frames"};
inline constexpr BufferKey<uint32_t> kNonfinite{"nonfinite"};
inline constexpr BufferKey<Rgb> kDenoised{"denoised"};

// --- Surfaces at pixels -------------------------------------------------------------------------------

/// What reprojection needs to know of the surface that a pixel shows. Position, normal and surface are double-buffered.
struct SurfaceBuffers {
  BufferKey<Vec2> motion;       ///< since the previous frame, pixels
  BufferKey<Vec3> previous;     ///< position one frame ago, metres
  BufferKey<Vec3> position;     ///< metres
  BufferKey<Vec3> normal;       ///< shading normal
  BufferKey<float> depth;       ///< metres
  BufferKey<uint32_t> surface;  ///< a number that differs between surfaces
};

/// First hits.
inline constexpr SurfaceBuffers kSurface{.motion = {"surface-motion"},
                                         .previous = {"surface-previous"},
                                         .position = {"surface-position"},
                                         .normal = {"surface-normal"},
                                         .depth = {"surface-depth"},
                                         .surface = {"surface-instance"}};
inline constexpr BufferKey<Rgb> kSurfaceAlbedo{"surface-albedo"};

/// First hits, or what specular reflection and refraction show in their place.
inline constexpr SurfaceBuffers kFeature{.motion = {"feature-motion"},
                                         .previous = {"feature-previous"},
                                         .position = {"feature-position"},
                                         .normal = {"feature-normal"},
                                         .depth = {"feature-depth"},
                                         .surface = {"feature-surface"}};
inline constexpr BufferKey<Rgb> kFeatureAlbedo{"feature-albedo"};
inline constexpr BufferKey<Rgb> kFeatureEmission{"feature-emission"};

/// Images in glossy reflections.
inline constexpr SurfaceBuffers kReflection{.motion = {"specular-motion"},
                                            .previous = {"specular-previous"},
                                            .position = {"specular-position"},
                                            .normal = {"specular-normal"},
                                            .depth = {"specular-depth"},
                                            .surface = {"feature-surface"}};
inline constexpr BufferKey<Rgb> kDiffuseAlbedo{"diffuse-albedo"};
inline constexpr BufferKey<Rgb> kSpecularAlbedo{"specular-albedo"};

}  // namespace relume

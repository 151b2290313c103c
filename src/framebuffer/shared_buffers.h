// Keys of buffers that several techniques use. The owner's declaration describes each buffer (PassDeclaration::owns).
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
inline constexpr BufferKey<Rgb> kCausticRadiance{"caustic-radiance"};    ///< the part in the caustic layer
/// The same part, from half of the light paths minus that from the others: its square estimates the variance that the
/// light paths cause.
inline constexpr BufferKey<Rgb> kCausticDifference{"caustic-difference"};
inline constexpr BufferKey<Rgb> kRadianceCells{"radiance-cells"};  ///< the part from cells of a cache
/// 1: cells show the light that the first surface reflects; 0: none, or that of a later surface.
inline constexpr BufferKey<uint32_t> kCellsAtHit{"cells-at-hit"};
inline constexpr BufferKey<uint32_t> kRays{"rays"};
inline constexpr BufferKey<uint32_t> kEdgeRays{"edge-rays"};

// --- Accumulated samples ------------------------------------------------------------------------------

inline constexpr BufferKey<Rgb> kMean{"mean"};
inline constexpr BufferKey<uint32_t> kSamples{"samples"};

/// Moments of each pixel's samples. Only AccumulatePass writes them. Until it runs, they are those of the previous
/// frame, at the previous frame's pixels.
inline constexpr MomentBuffers kMoments{.mean = kMean, .m2 = {"m2"}, .m2_rgb = {"m2-rgb"}, .samples = kSamples};
inline constexpr BufferKey<Rgb> kSpecularMean{"specular-mean"};  ///< the part of kMean from specular lobes
inline constexpr BufferKey<uint32_t> kSpecularSamples{"specular-samples"};
inline constexpr BufferKey<Rgb> kCellsMean{"cells-mean"};  ///< the part of kMean from cells of a cache
inline constexpr BufferKey<uint32_t> kCellsSamples{"cells-samples"};

/// Moments reprojected to this frame's pixels, before this frame's sample. They exist only with reprojection.
inline constexpr MomentBuffers kInherited{.mean = {"inherited-mean"},
                                          .m2 = {"inherited-m2"},
                                          .m2_rgb = {"inherited-m2-rgb"},
                                          .samples = {"inherited-samples"}};
inline constexpr BufferKey<Rgb> kInheritedSpecularMean{"inherited-specular-mean"};
inline constexpr BufferKey<uint32_t> kInheritedSpecularSamples{"inherited-specular-samples"};
inline constexpr BufferKey<Rgb> kInheritedCellsMean{"inherited-cells-mean"};
inline constexpr BufferKey<uint32_t> kInheritedCellsSamples{"inherited-cells-samples"};

inline constexpr BufferKey<Rgb> kLightMean{"light-mean"};  ///< from light paths, which reach every pixel
inline constexpr BufferKey<float> kLightM2{"light-m2"};
inline constexpr BufferKey<float> kLightPaths{"light-paths"};
inline constexpr BufferKey<uint32_t> kLightFrames{"light-frames"};

/// Moments of the caustic layer: of kCausticRadiance, as kMoments are of kRadiance.
inline constexpr MomentBuffers kCausticMoments{
    .mean = {"caustics"}, .m2 = {"caustics-m2"}, .m2_rgb = {}, .samples = {"caustics-samples"}};
inline constexpr BufferKey<uint32_t> kNonfinite{"nonfinite"};
inline constexpr BufferKey<Rgb> kFilled{"filled"};  ///< kMean without unsampled pixels; exists with temporal upscaling
inline constexpr BufferKey<Rgb> kDenoised{"denoised"};

// --- Surfaces at pixels -------------------------------------------------------------------------------

/// Surface properties per pixel for reprojection. Position, normal and surface are double-buffered.
struct SurfaceBuffers {
  BufferKey<Vec2> motion;       ///< since the previous frame, pixels
  BufferKey<Vec3> previous;     ///< position in the previous frame, metres
  BufferKey<Vec3> position;     ///< metres
  BufferKey<Vec3> normal;       ///< shading normal
  BufferKey<float> depth;       ///< metres
  BufferKey<uint32_t> surface;  ///< number that identifies the surface
};

/// Surfaces at first hits.
inline constexpr SurfaceBuffers kSurface{.motion = {"surface-motion"},
                                         .previous = {"surface-previous"},
                                         .position = {"surface-position"},
                                         .normal = {"surface-normal"},
                                         .depth = {"surface-depth"},
                                         .surface = {"surface-instance"}};
inline constexpr BufferKey<Rgb> kSurfaceAlbedo{"surface-albedo"};

/// Surfaces at first hits, or those seen in specular reflection and refraction.
inline constexpr SurfaceBuffers kFeature{.motion = {"feature-motion"},
                                         .previous = {"feature-previous"},
                                         .position = {"feature-position"},
                                         .normal = {"feature-normal"},
                                         .depth = {"feature-depth"},
                                         .surface = {"feature-surface"}};
inline constexpr BufferKey<Rgb> kFeatureAlbedo{"feature-albedo"};
inline constexpr BufferKey<Rgb> kFeatureEmission{"feature-emission"};

/// Surfaces seen in glossy reflections.
inline constexpr SurfaceBuffers kReflection{.motion = {"specular-motion"},
                                            .previous = {"specular-previous"},
                                            .position = {"specular-position"},
                                            .normal = {"specular-normal"},
                                            .depth = {"specular-depth"},
                                            .surface = {"feature-surface"}};
inline constexpr BufferKey<Rgb> kDiffuseAlbedo{"diffuse-albedo"};
inline constexpr BufferKey<Rgb> kSpecularAlbedo{"specular-albedo"};

}  // namespace relume

// Common parts of denoisers: the light at surfaces that they filter, its history, and the final image.
#pragma once

#include <string_view>
#include <vector>

#include "frame/pass.h"
#include "frame/primitives/fill.h"
#include "frame/primitives/primitive.h"
#include "techniques/denoise/shared/history_settings.h"
#include "techniques/denoise/shared/light_history.h"

namespace relume {

inline constexpr BufferKey<Rgb> kShownEmission{"shown-emission"};        ///< emission that the image shows
inline constexpr BufferKey<Rgb> kScattered{"scattered"};                 ///< radiance of a sample without its emission
inline constexpr BufferKey<Rgb> kDiffuseScattered{"diffuse-scattered"};  ///< part of it from diffuse lobes
inline constexpr BufferKey<Rgb> kSpecularScattered{"specular-scattered"};
inline constexpr BufferKey<Rgb> kCausticAlbedo{"caustic-albedo"};        ///< 1 where light is filtered, else 0
inline constexpr BufferKey<Rgb> kFilteredCaustics{"filtered-caustics"};  ///< filtered caustic layer of this frame

/// Changes that end the histories of denoisers.
inline constexpr Change kEndsDenoiserHistory = Change::materials | Change::settings;

/// A double-buffered history of a denoiser.
BufferDescription denoiser_history(const BufferId& id, const char* help);

/// Image of the denoiser.
BufferDescription denoised_buffer();

/// State of finish_image(): the unfiltered part of the image, and the fraction of frames in which each pixel was
/// filtered.
BufferDescription unfiltered_buffer();
BufferDescription filtered_share_buffer();

/// Features and samples that a denoiser reads, for its declaration.
std::vector<BufferId> feature_buffers();

/// Part of the light at a surface in a history. `caustics`: the caustic layer, which the others do not contain.
enum class LightPart : int { whole, diffuse, specular, caustics };

/// Adds the buffers that a denoiser also reads if it keeps diffuse and specular light apart.
void add_split_buffers(std::vector<BufferId>& reads);

/// Whether any pixel has separate specular light. A frame without any does no work for its histories.
class ReflectingFrames {
 public:
  /// Call once in each frame in which light is kept apart.
  void begin_frame(const FrameContext& frame, PrimitiveScratch& scratch);
  /// Undoes begin_frame() when the frame is abandoned.
  void abandon_frame();

  bool now() const { return now_; }
  /// In this frame or the previous one, whose specular light must still be blended.
  bool recently() const { return now_ || before_; }

 private:
  // After a checkpoint, the first frame blends empty buffers, which changes nothing.
  bool now_ = true;
  bool before_ = true;
  bool earliest_ = true;  ///< `before_` of the previous frame
};

/// Views of this frame's samples for a part of the light, with its albedo and the shown emission.
SurfaceLight surface_light(const FrameContext& frame, LightPart part = LightPart::whole);

/// Double-buffered history of light, which the denoiser owns.
struct LightHistoryBuffers {
  BufferKey<Rgb> light;
  BufferKey<uint32_t> samples;
};
/// Accumulation of this frame's samples in `buffers`. The history counts without a limit while nothing changes.
LightHistory light_history(const FrameContext& frame, const LightHistoryBuffers& buffers,
                           const DenoiserHistorySettings& settings, LightPart part = LightPart::whole);

/// Zeroes a buffer of specular light, for frames without any.
template <typename T>
void clear_buffer(const FrameContext& frame, const BufferKey<T>& key) {
  fill(frame.backend, "clear", frame.write(key), T(0));
}

/// Buffers of a denoiser's last step, which the denoiser owns: `shown`, this frame's filtered image, and `history`,
/// double-buffered. It also owns denoised_buffer(), unfiltered_buffer() and filtered_share_buffer(). See
/// image_history.h.
struct ImageBuffers {
  std::string_view launch_name;
  BufferKey<Rgb> shown;
  BufferKey<Rgb> history;
  BufferKey<uint32_t> samples;  ///< sample count of each pixel's light, including this frame
  /// The same for the specular part of `shown` and `history`; without names if light is not kept apart.
  struct Specular {
    BufferKey<Rgb> shown;
    BufferKey<Rgb> history;
    BufferKey<uint32_t> samples;
  } specular = {};
};
/// Whether most filtered pixels have no samples from earlier frames, as at the start and after a cut; while upscaling,
/// no samples at all. Tests one pixel in 61.
bool lacks_history(const FrameContext& frame, PrimitiveScratch& scratch, const BufferKey<uint32_t>& samples,
                   const BufferKey<uint32_t>& specular_samples = {});

/// Averages the image over time and blends it to the mean of all samples. `newest`: weight of this frame where
/// something moves. False if a stop was requested first.
[[nodiscard]] bool finish_image(const FrameContext& frame, PrimitiveScratch& scratch, const ImageBuffers& buffers,
                                float newest);

}  // namespace relume

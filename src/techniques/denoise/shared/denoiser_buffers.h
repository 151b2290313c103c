// What denoisers have in common: the light at surfaces that they filter, its history, and the image that they present.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "frame/pass.h"
#include "techniques/denoise/shared/history_settings.h"
#include "techniques/denoise/shared/light_history.h"

namespace relume {

inline constexpr BufferKey<Rgb> kShownEmission{"shown-emission"};        ///< emission that the image shows
inline constexpr BufferKey<Rgb> kScattered{"scattered"};                 ///< radiance of a sample without it
inline constexpr BufferKey<Rgb> kDiffuseScattered{"diffuse-scattered"};  ///< the part from diffuse lobes
inline constexpr BufferKey<Rgb> kSpecularScattered{"specular-scattered"};

/// Changes that no denoiser's history survives.
inline constexpr Change kEndsDenoiserHistory = Change::materials | Change::settings;

/// A double-buffered history of a denoiser.
BufferDescription denoiser_history(const BufferId& id, const char* help);

/// Where every denoiser leaves its image.
BufferDescription denoised_buffer();

/// What finish_image() keeps of lamps and sky, and of how often a pixel shows other things.
BufferDescription unfiltered_buffer();
BufferDescription filtered_share_buffer();

/// What a denoiser reads of the features and samples, for its declaration.
std::vector<BufferId> feature_buffers();

/// Which part of the light at a surface a history holds.
enum class LightPart : int { whole, diffuse, specular };

/// What a denoiser reads besides if it keeps diffuse and specular light apart.
void add_split_buffers(std::vector<BufferId>& reads);

/// Whether any pixel keeps specular light apart. A frame without one does no work for its histories.
class ReflectingFrames {
 public:
  /// Call once in each frame in which light is kept apart.
  void begin_frame(const FrameContext& frame);
  /// Undoes that when the frame is abandoned.
  void abandon_frame();

  bool now() const { return now_; }
  /// In this frame or the one before, whose specular light still has to be blended.
  bool recently() const { return now_ || before_; }

 private:
  // After a checkpoint the first frame blends empty buffers, which changes nothing.
  bool now_ = true;
  bool before_ = true;
  bool earliest_ = true;  ///< `before_` of the frame before
};

/// This frame's samples beside its features.
SurfaceLight surface_light(const FrameContext& frame, LightPart part = LightPart::whole);

/// What a denoiser remembers of light, in double-buffered buffers of its own.
struct LightHistoryBuffers {
  BufferKey<Rgb> light;
  BufferKey<uint32_t> samples;
};
/// What accumulates this frame's samples there. The past counts without a limit where nothing has changed.
LightHistory light_history(const FrameContext& frame, const LightHistoryBuffers& buffers,
                           const DenoiserHistorySettings& settings, LightPart part = LightPart::whole);

/// Leaves a history of specular light without samples.
template <typename T>
void clear_buffer(const FrameContext& frame, const BufferKey<T>& key) {
  const View<T> values = frame.write(key);
  std::fill(values.begin(), values.end(), T(0));
}

/// The last step of a denoiser, which owns these besides kDenoised and the two above: `shown`, this frame's filtered
/// image, and `history`, double-buffered. See image_history.h.
struct ImageBuffers {
  std::string_view launch_name;
  BufferKey<Rgb> shown;
  BufferKey<Rgb> history;
  BufferKey<uint32_t> samples;  ///< of each pixel's light, this frame's included
  /// The same of the specular part of `shown` and `history`; without names if light is not kept apart.
  struct Specular {
    BufferKey<Rgb> shown;
    BufferKey<Rgb> history;
    BufferKey<uint32_t> samples;
  } specular = {};
};
/// Whether most filtered pixels have no sample from earlier frames, as at the start and after a cut. Judged by one
/// pixel in 61.
bool lacks_history(const FrameContext& frame, const BufferKey<uint32_t>& samples,
                   const BufferKey<uint32_t>& specular_samples = {});

/// `newest`: weight of this frame where something moves. False if a stop was requested first.
[[nodiscard]] bool finish_image(const FrameContext& frame, const ImageBuffers& buffers, float newest);

}  // namespace relume

// Encodes frames on a thread of its own: once per level, however many viewers watch.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "serve/link_control.h"
#include "viewer/render/display_table.h"
#include "viewer/render/display_transform.h"
#include "viewer/render/request.h"

namespace relume::serve {

/// The displayed image: one or two frames, and how they become colours. Immutable once it is shared.
struct ShownImage {
  uint64_t version = 0;  ///< counts images
  std::array<std::shared_ptr<const viewer::ViewerFrame>, viewer::kSides> frames;
  std::array<viewer::DisplayTransform, viewer::kSides> transforms;
  viewer::OcioDisplay ocio;  ///< keeps the table of the transforms
  float split_at = 1;        ///< side B begins here, in widths; 1: A alone
  uint32_t viewer = 0;       ///< whose input the frames follow
  uint32_t input = 0;        ///< newest input of this viewer that the frames follow
};

struct EncodedImage {
  uint64_t version = 0;
  int level = 0;  ///< index in kLevels; kPngLevel: PNG
  uint32_t viewer = 0;
  uint32_t input = 0;
  int width = 0;  ///< of the image, before the level's division
  int height = 0;
  std::vector<uint8_t> bytes;
};

inline constexpr int kPngLevel = static_cast<int>(kLevels.size());

/// Colours of an image, three bytes per pixel.
struct Colors {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgb;
};

/// Means of blocks of `divisor`² pixels; those at the right and lower edge may be smaller.
Colors shrunk(const Colors& colors, int divisor);

/// Encodes as JPEG. Throws Error.
std::vector<uint8_t> encode_jpeg(const Colors& colors, int quality);

class FrameEncoder {
 public:
  using Done = std::function<void(std::shared_ptr<const EncodedImage>)>;

  /// `done` is called on the encoder's thread.
  explicit FrameEncoder(Done done);
  ~FrameEncoder();
  FrameEncoder(const FrameEncoder&) = delete;
  FrameEncoder& operator=(const FrameEncoder&) = delete;

  /// Encodes the image at a level. A newer image replaces one that waits, at all levels that wait.
  void request(std::shared_ptr<const ShownImage> image, int level);

 private:
  void run(const std::stop_token& stop);
  void develop(const ShownImage& image);
  const viewer::DisplayTable& table_of(const viewer::DisplayTransform& transform);
  std::shared_ptr<const EncodedImage> encode(const ShownImage& image, int level) const;

  Done done_;
  std::mutex mutex_;  ///< guards the next two
  std::condition_variable_any wake_;
  std::shared_ptr<const ShownImage> image_;
  std::array<bool, kLevels.size() + 1> wanted_{};

  // Used only by the thread.
  uint64_t developed_ = 0;  ///< version of `colors_`
  Colors colors_;
  std::optional<ToneMap> tone_map_;  ///< of `tone_table_`
  viewer::DisplayTable tone_table_;
  std::jthread thread_;  ///< last: it must end before the other members
};

}  // namespace relume::serve

// Renders the samples that a rank is dealt.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <stop_token>
#include <vector>

#include "framebuffer/pixel_sums.h"
#include "ranks/link.h"
#include "relume/session.h"

namespace relume::ranks {

/// Content of MessageKind::deal for a still image.
struct SampleWork {
  uint32_t id = 0;
  uint32_t first = 0;
  uint32_t count = 0;
  double time_left_s = 0;  ///< of --time; infinite: none
};

/// Begin of MessageKind::samples. The sums of the blocks, and then of the samples after them, follow where there are
/// any.
struct SampleResult {
  uint32_t id = 0;
  uint32_t first = 0;   ///< sample
  uint32_t blocks = 0;  ///< samples in complete blocks
  uint32_t rest = 0;    ///< samples after them
  uint32_t correlated_frames = 1;
  uint32_t is_cut_off = 0;  ///< whether time ended before the deal
  double seconds = 0;
};

/// Content of MessageKind::progress and rendered.
struct WorkProgress {
  uint32_t id = 0;
  uint32_t samples = 0;
  uint64_t rays = 0;   ///< of this rank so far
  double seconds = 0;  ///< of rendering of this rank so far
};

/// Bytes of the sums of a pixel in messages. `surface`: with SurfaceSums.
size_t message_bytes(bool surface);
/// Adds the sums of a message to `sums`.
void add_message_sums(std::span<const std::byte> bytes, bool surface, std::span<PixelSums> sums);

class SampleWorker {
 public:
  SampleWorker(Session& session, RankLink& link);
  ~SampleWorker();
  SampleWorker(const SampleWorker&) = delete;
  SampleWorker& operator=(const SampleWorker&) = delete;

  /// Renders deals until no work is left.
  void run();
  /// Number of cancelled deals in the list.
  size_t cancelled_deals() const;

 private:
  void interrupt(const Message& message);
  void forget(uint32_t id);
  std::stop_token begin(uint32_t id);
  void render(const SampleWork& work);
  bool render_frames(const SampleWork& work, const std::stop_token& stop, SampleResult& result);
  void send(const SampleResult& result);
  bool wait_for_link();
  void report(MessageKind kind, uint32_t id, uint32_t samples);

  Session& session_;
  RankLink& link_;
  bool surface_;
  std::vector<PixelSums> blocks_;
  std::vector<PixelSums> rest_;
  std::optional<uint32_t> position_;  ///< sample of the next frame, if the session may continue there
  bool any_ = false;                  ///< whether a frame is complete: the first one ignores the time
  double render_s_ = 0;
  double reported_s_ = 0;
  mutable std::mutex mutex_;  ///< guards the members below
  std::stop_source stop_;
  uint32_t current_ = 0;          ///< id of the deal in progress; 0: none
  std::set<uint32_t> cancelled_;  ///< deals that were cancelled before they began, or after they ended
  bool finished_ = false;
};

}  // namespace relume::ranks

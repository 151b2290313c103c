// Interface of a frame to its passes.
#pragma once

#include <stop_token>
#include <string_view>
#include <utility>
#include <vector>

#include "frame/launch.h"
#include "framebuffer/buffer_table.h"
#include "framebuffer/shared_buffers.h"
#include "sampling/sample_index.h"
#include "scene/scene_view.h"

namespace relume {

struct VisibleSet;

/// The buffers that a pass has declared. Throws std::logic_error with pass and buffer for any other: an error in the
/// pass, not in user input.
class BufferAccess {
 public:
  virtual ~BufferAccess() = default;
  virtual void check_read(const BufferId& buffer) const = 0;
  virtual void check_write(const BufferId& buffer) const = 0;
  /// Checks that the pass moves the buffers that follow surfaces.
  virtual void check_move(const BufferId& buffer) const = 0;
};

/// State of a frame, and the changes before it.
struct FrameState {
  SampleIndex index = {};
  uint32_t number = 0;            ///< frames since the session began
  uint32_t since_change = 0;      ///< frames since the last change
  Change changes = Change::none;  ///< since the previous frame
  bool begins_image = false;      ///< first frame of an image: of a sequence, or after a change
  bool ends_pilot = false;        ///< whether the pilot's samples are dropped from the image in this frame
  bool begins_epoch = true;       ///< whether learned structures are replaced by those of later samples
  uint32_t turns = 1;             ///< number of frames over which every pixel gets one sample
  bool stratified = false;        ///< whether a pixel's samples since the last change form one low-discrepancy sequence
  uint32_t correlated_frames = 1;        ///< as Pass::correlated_frames(), of all passes
  std::stop_token stop = {};             ///< empty after a pass has committed to the frame
  Tile window = {};                      ///< rendered pixels; empty: all pixels
  std::stop_token hurry = {};            ///< if requested, preparation that a later frame can continue ends early
  bool observed = false;                 ///< whether a hook may read and change buffers after each pass
  View<const uint16_t> blue_noise = {};  ///< blue_noise_tile(), if the settings use it
  const std::vector<VisibleSet>* visible_sets = nullptr;  ///< of the scene, on the host; nullptr: unknown
};

/// Size of the grid of a kernel launch.
struct Grid {
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t tile_size = kTileSize;  ///< edge of the square of elements per task; small for expensive elements
};

class FrameContext : public FrameState {
 public:
  /// A context with access to all buffers of `table`. The arguments must outlive it.
  FrameContext(const SceneView& scene_view, BufferTable& table, Backend& runs_on, const FrameState& state)
      : FrameState(state), scene(scene_view), backend(runs_on), buffers_(table) {}
  /// The same frame, limited to the buffers that `access` allows.
  FrameContext limited_to(const BufferAccess& access) const {
    FrameContext limited = *this;
    limited.access_ = &access;
    return limited;
  }

  const SceneView& scene;
  Backend& backend;

  uint32_t width() const { return buffers_.width(); }
  uint32_t height() const { return buffers_.height(); }
  uint32_t pixels() const { return width() * height(); }
  /// Rendered pixels.
  Tile rendered() const { return window.x1 > 0 ? window : Tile{0, 0, width(), height()}; }

  /// Elements of a buffer; an empty view if this frame lacks it. Both check that the pass has declared the access.
  template <typename T>
  View<const T> read(const BufferKey<T>& key) const {
    if (access_) access_->check_read(key);
    return buffers_.view(key);
  }
  template <typename T>
  View<T> write(const BufferKey<T>& key) const {
    if (access_) access_->check_write(key);
    return buffers_.mutable_view(key);
  }
  /// Elements of a double-buffered buffer in the previous frame.
  template <typename T>
  View<const T> previous(const BufferKey<T>& key) const {
    if (access_) access_->check_read(key);
    return buffers_.previous(key);
  }

  /// Returns a buffer that the pass may read on the host after the frame; nullptr if the frame lacks it. Valid as long
  /// as the pass. Checks access like read().
  template <typename T>
  const Buffer* buffer(const BufferKey<T>& key) const {
    if (access_) access_->check_read(key);
    return std::as_const(buffers_).find(key.name);
  }

  /// Calls f(buffer) for each buffer that follows the surface.
  template <typename F>
  void for_each_surface_buffer(const F& f) const {
    for (const auto& buffer : buffers_.all()) {
      if (!buffer->description().follows_surface) continue;
      if (access_) access_->check_move(buffer->description().id);
      f(*buffer);
    }
  }

  /// Runs a kernel for every rendered pixel and ignores stop requests.
  template <LaunchableKernel K>
  void launch(std::string_view name, const K& kernel) const {
    relume::launch(backend, name, kernel, rendered());
  }
  /// Runs a kernel for every element of `grid`.
  template <LaunchableKernel K>
  void launch(std::string_view name, const K& kernel, const Grid& grid) const {
    relume::launch(backend, name, kernel, grid.width, grid.height, {}, grid.tile_size);
  }
  /// Runs a kernel for every rendered pixel. Returns false if a stop was requested first; the pass must then return
  /// false.
  template <LaunchableKernel K>
  [[nodiscard]] bool launch_or_stop(std::string_view name, const K& kernel) const {
    return relume::launch(backend, name, kernel, rendered(), stop);
  }
  /// The same for every element of `grid`.
  template <LaunchableKernel K>
  [[nodiscard]] bool launch_or_stop(std::string_view name, const K& kernel, const Grid& grid) const {
    return relume::launch(backend, name, kernel, grid.width, grid.height, stop, grid.tile_size);
  }
  /// Host: calls `work(tile)` for the tiles of all rendered pixels, on all threads. Returns false if a stop was
  /// requested first.
  template <typename Work>
  [[nodiscard]] bool launch_tiles_or_stop(std::string_view name, const Work& work) const {
    return relume::launch_tiles(backend, name, work, rendered(), stop);
  }

 private:
  BufferTable& buffers_;
  const BufferAccess* access_ = nullptr;
};

}  // namespace relume

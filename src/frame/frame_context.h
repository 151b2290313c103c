// What every pass of a frame gets to see.
#pragma once

#include <stop_token>
#include <string_view>

#include "frame/launch.h"
#include "framebuffer/buffer_table.h"
#include "framebuffer/shared_buffers.h"
#include "sampling/sample_index.h"
#include "scene/scene_view.h"

namespace relume {

/// The buffers that a pass has declared. Throws std::logic_error, naming pass and buffer, for any other: a mistake in
/// the pass, not of a user.
class BufferAccess {
 public:
  virtual ~BufferAccess() = default;
  virtual void check_read(const BufferId& buffer) const = 0;
  virtual void check_write(const BufferId& buffer) const = 0;
  /// That the pass moves the buffers that follow surfaces.
  virtual void check_move(const BufferId& buffer) const = 0;
};

/// Which frame it is, and what has changed before it.
struct FrameState {
  SampleIndex index = {};
  uint32_t number = 0;            ///< frames since the session began
  uint32_t since_change = 0;      ///< frames since the last change
  Change changes = Change::none;  ///< since the previous frame
  bool begins_image = false;      ///< the first frame of an image: of a sequence, or after a change
  bool ends_pilot = false;        ///< the samples of the pilot leave the image with this frame
  bool begins_epoch = true;       ///< structures that learn are replaced by what later samples have added
  bool stratified = false;     ///< a pixel's samples since the last change are one low-discrepancy sequence of its own
  std::stop_token stop = {};   ///< empty once a pass has committed to the frame
  Tile window = {};            ///< the pixels that are rendered; without any: all
  std::stop_token hurry = {};  ///< requested: preparation that a later frame can continue ends early
};

/// The elements that a kernel is launched for.
struct Grid {
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t tile_size = kTileSize;  ///< edge of the square that one task treats; small for elements that take long
};

class FrameContext : public FrameState {
 public:
  /// A context with access to all buffers of `table`. What it refers to must outlive it.
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
  /// The pixels that are rendered.
  Tile rendered() const { return window.x1 > 0 ? window : Tile{0, 0, width(), height()}; }

  /// Elements of a buffer; an empty view if this frame lacks it. Each checks that the pass has declared the access.
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
  /// Elements of a double-buffered buffer one frame ago.
  template <typename T>
  View<const T> previous(const BufferKey<T>& key) const {
    if (access_) access_->check_read(key);
    return buffers_.previous(key);
  }

  /// Calls f(buffer) for each that follows the surface.
  template <typename F>
  void for_each_surface_buffer(const F& f) const {
    for (const auto& buffer : buffers_.all()) {
      if (!buffer->description().follows_surface) continue;
      if (access_) access_->check_move(buffer->description().id);
      f(*buffer);
    }
  }

  /// Runs a kernel for every pixel that is rendered, whatever is requested meanwhile.
  template <PassKernel K>
  void launch(std::string_view name, const K& kernel) const {
    relume::launch(backend, name, kernel, rendered());
  }
  /// Runs a kernel for every element of `grid`.
  template <PassKernel K>
  void launch(std::string_view name, const K& kernel, const Grid& grid) const {
    relume::launch(backend, name, kernel, grid.width, grid.height, {}, grid.tile_size);
  }
  /// Runs a kernel for every pixel that is rendered. False if a stop was requested first; the pass then has to return
  /// false.
  template <PassKernel K>
  [[nodiscard]] bool launch_or_stop(std::string_view name, const K& kernel) const {
    return relume::launch(backend, name, kernel, rendered(), stop);
  }
  /// The same for every element of `grid`.
  template <PassKernel K>
  [[nodiscard]] bool launch_or_stop(std::string_view name, const K& kernel, const Grid& grid) const {
    return relume::launch(backend, name, kernel, grid.width, grid.height, stop, grid.tile_size);
  }

 private:
  BufferTable& buffers_;
  const BufferAccess* access_ = nullptr;
};

}  // namespace relume

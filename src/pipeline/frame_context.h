// What every pass of a frame gets to see.
#pragma once

#include <string_view>
#include <type_traits>

#include "backend/launch.h"
#include "film/buffer_table.h"
#include "sampling/sample_index.h"
#include "scene/scene_view.h"

namespace relume {

/// The buffers that a pass has declared. Throws std::logic_error, naming pass and buffer, for any other: a mistake in
/// the pass, not of a user.
class BufferAccess {
 public:
  virtual ~BufferAccess() = default;
  virtual void check_read(std::string_view buffer) const = 0;
  virtual void check_write(std::string_view buffer) const = 0;
  /// That the pass moves what follows the surface.
  virtual void check_move(std::string_view buffer) const = 0;
};

struct FrameContext {
  const SceneView& scene;
  BufferTable& buffers;
  Backend& backend;
  SampleIndex index;
  uint32_t number = 0;            ///< frames since the session began
  uint32_t since_change = 0;      ///< frames since anything changed
  Change changes = Change::none;  ///< since the frame before
  std::stop_token stop;           ///< set only if no pass remembers anything beyond its buffers
  bool begins_picture = false;    ///< the first frame of a picture: of a sequence, or after a change
  bool begins_epoch = true;       ///< paths sample with all that was learned so far, not with a snapshot of it
  bool stratified = false;  ///< a pixel's samples since the last change are one low-discrepancy sequence, and its own
  const BufferAccess* access = nullptr;  ///< of the pass that runs; nullptr: everything
  std::stop_token hurry =
      {};  ///< requested: preparation that a later frame can continue ends early; the frame does not

  uint32_t width() const { return buffers.width(); }
  uint32_t height() const { return buffers.height(); }
  uint32_t pixels() const { return width() * height(); }

  /// Elements of a buffer that the pass has declared to read, or to write unless T is const; empty if there is none of
  /// that name.
  template <typename T>
  View<T> view(std::string_view name) const {
    if (access) std::is_const_v<T> ? access->check_read(name) : access->check_write(name);
    return buffers.view<T>(name);
  }
  /// Its elements one frame ago.
  template <typename T>
  View<T> previous(std::string_view name) const {
    if (access) access->check_read(name);
    return buffers.previous<T>(name);
  }

  /// Calls f(buffer) for each that follows the surface.
  template <typename F>
  void for_each_surface_buffer(const F& f) const {
    for (const auto& buffer : buffers.all()) {
      if (!buffer->description().follows_surface) continue;
      if (access) access->check_move(buffer->description().name);
      f(*buffer);
    }
  }

  /// Runs a kernel for every pixel. False if a stop was requested first.
  template <PassKernel K>
  bool launch(std::string_view name, const K& kernel) const {
    return relume::launch(backend, name, kernel, width(), height(), stop);
  }
};

}  // namespace relume

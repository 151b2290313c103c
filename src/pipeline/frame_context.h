// What every pass of a frame gets to see.
#pragma once

#include "backend/launch.h"
#include "film/buffer_table.h"
#include "sampling/sample_index.h"
#include "scene/scene_view.h"

namespace relume {

struct FrameContext {
  const SceneView& scene;
  BufferTable& buffers;
  Backend& backend;
  SampleIndex index;
  uint32_t number = 0;            ///< frames since the session began
  uint32_t since_change = 0;      ///< frames since anything changed
  Change changes = Change::none;  ///< since the frame before
  std::stop_token stop;           ///< set only if no pass remembers anything beyond its buffers

  uint32_t width() const { return buffers.width(); }
  uint32_t height() const { return buffers.height(); }
  uint32_t pixels() const { return width() * height(); }

  /// Elements of a buffer; empty if there is none of that name.
  template <typename T>
  View<T> view(std::string_view name) const {
    return buffers.view<T>(name);
  }
  /// Its elements one frame ago.
  template <typename T>
  View<T> previous(std::string_view name) const {
    return buffers.previous<T>(name);
  }

  /// Runs a kernel for every pixel. False if a stop was requested first.
  template <PassKernel K>
  bool launch(std::string_view name, const K& kernel) const {
    return relume::launch(backend, name, kernel, width(), height(), stop);
  }
};

}  // namespace relume

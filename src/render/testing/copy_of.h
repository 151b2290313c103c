// Copies of a session's buffers.
#pragma once

#include <utility>
#include <vector>

#include "render/session.h"

namespace relume::testing {

/// The elements of a buffer after the last frame.
template <typename T>
std::vector<T> copy_of(const Session& session, const BufferKey<T>& buffer) {
  const View<const T> view = buffer_table(session).read(buffer);
  return {view.begin(), view.end()};
}

/// A buffer of the third frame.
template <typename T>
std::vector<T> third_frame(const RenderSettings& settings, const BufferKey<T>& buffer, Scene scene) {
  Session session(std::move(scene), settings);
  for (int i = 0; i < 3; ++i) session.render_frame();
  return copy_of(session, buffer);
}

}  // namespace relume::testing

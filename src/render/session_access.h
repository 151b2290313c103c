// Access to the state of a session for code of this folder.
#pragma once

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "relume/session.h"
#include "render/session_state.h"

namespace relume {

/// Name of launches between frames in timings. Statistics omit their times.
inline constexpr std::string_view kBetweenFrames = "statistics";

struct SessionAccess {
  static const Session::State& state(const Session& session) { return *session.state_; }
  static Session::State& state(Session& session) { return *session.state_; }
  /// A session on `target`, a Memory or a Device. The size in `settings` must be valid.
  template <typename Target>
  static Session make(Scene scene, const RenderSettings& settings, Target&& target) {
    return Session(std::make_unique<Session::State>(std::move(scene), settings, std::vector<Index>(),
                                                    std::forward<Target>(target)));
  }
};

}  // namespace relume

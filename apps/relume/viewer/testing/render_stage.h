// A rendering thread and a complete request.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "builtin_scenes/builtin.h"
#include "viewer/model/document.h"
#include "viewer/render/render_thread.h"

namespace relume::viewer::testing {

inline constexpr int kPatience_ms = 60000;  // allows for a busy machine

/// A request for a small image of a scene.
struct Stage {
  explicit Stage(const char* builtin = "cornell") : Stage(builtin, find_builtin_scene(builtin)->build()) {}
  Stage(const std::string& name, Scene scene)
      : document(std::make_shared<const LoadedScene>(LoadedScene{name, std::move(scene)})) {
    for (AllSettings& s : settings) {
      s.render.width = 32;
      s.render.height = 24;
      s.render.threads = 1;
      s.render.path.max_bounces = 2;
    }
  }

  void post() {
    RenderRequest request;
    request.version = request.image_version = ++version;
    request.scene = document.loaded();
    request.edits = document.edits();
    request.settings = settings;
    request.split = split;
    request.paused = paused;
    request.buffer = buffer;
    request.resolution_policy = resolution_policy;
    thread.post(request);
  }

  /// The first frame that follows the newest request; nullptr if none arrives.
  std::shared_ptr<const ViewerFrame> next(int side = 0) {
    for (int i = 0; i < kPatience_ms; ++i) {
      auto frame = thread.frame(side);
      if (frame && frame->request_version >= version) return frame;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return nullptr;
  }

  std::string problem() {
    for (int i = 0; i < kPatience_ms; ++i) {
      for (const Notice& notice : thread.take_notices()) {
        if (notice.problem) return notice.text;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return "no problem";
  }

  Document document;
  std::array<AllSettings, kSides> settings;
  bool split = false;
  bool paused = false;
  std::string buffer;
  ResolutionPolicy resolution_policy{.hold_rate = false};
  uint64_t version = 0;
  RenderThread thread;
};

}  // namespace relume::viewer::testing

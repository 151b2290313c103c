// The viewer behind the page: the state of the window's viewer, steered by messages.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <stop_token>
#include <string>

#include "core/vec.h"
#include "serve/inbox.h"
#include "serve/message.h"
#include "serve/publisher.h"
#include "viewer/model/frame_display.h"
#include "viewer/model/state.h"
#include "viewer/model/view_loop.h"

namespace relume::serve {

inline constexpr int kLeastSide = 64;         ///< of images that the page sizes, pixels
inline constexpr int kMostSide = 4096;        ///< of images
inline constexpr size_t kMostBookmarks = 32;  ///< stored from the page

/// Throws Error if the page may not give this value: one that names a file, or an image that is too large. `start`: the
/// settings with which the server started, whose environment is always permitted.
void check_page_value(const AllSettings& start, const std::string& name, const std::string& value);

/// Size of an image in this area of the page: even, and from kLeastSide to kMostSide.
IVec2 image_size(const Resize& area);

struct ModelOptions {
  AllSettings settings;
  bool fixed_size = false;  ///< otherwise the page determines the size of the image
  float target_hz = 30;
  bool watch = true;
  bool renders_unwatched = false;  ///< whether rendering continues while no viewer is connected
};

struct ShownImage;

class Model {
 public:
  /// `inbox` and `publisher` outlive this object.
  Model(const ModelOptions& options, std::shared_ptr<const viewer::LoadedScene> scene, viewer::OcioDisplay ocio,
        Inbox& inbox, Publisher& publisher);

  /// Until a stop is requested. Throws Error if the first scene cannot be shown as it started, or a GPU is lost.
  void run(const std::stop_token& stop);

  /// One turn of run(), without waiting.
  void turn(double now_s);

  const viewer::State& state() const { return state_; }
  viewer::RenderThread& renderer() { return renderer_; }
  bool loading() const { return state_.loading.valid() || !state_.superseded.empty(); }

 private:
  void take(const Input& input);
  void act(const MessageBody& body);
  void press(Button button);
  void use_bookmark(const UseBookmark& use);
  void resize(const Resize& size);
  void change(const ChangeSetting& change);
  void follow_viewers();
  void follow_inputs();
  void show_image();
  void tell_texts();
  double wait_s() const;

  Inbox& inbox_;
  Publisher& publisher_;
  AllSettings start_;  ///< settings
  bool renders_unwatched_;
  viewer::State state_;
  viewer::ViewLoop loop_;
  viewer::FrameDisplay display_;
  Fly held_;
  uint32_t held_by_ = 0;  ///< viewer
  double held_until_s_ = 0;
  bool edited_ = false;   ///< whether a page changed settings: it sees their errors, and the server continues
  bool has_news_ = true;  ///< whether viewers should get the status at once
  double status_s_ = 0;   ///< time of the last status
  std::string values_;    ///< last told

  /// Inputs that no frame follows so far, and the requests that carry them.
  struct PendingInput {
    uint64_t version;
    uint32_t viewer;
    uint32_t number;
  };
  uint32_t newest_viewer_ = 0;  ///< of the newest input in this turn
  uint32_t newest_number_ = 0;
  std::deque<PendingInput> pending_;
  uint32_t followed_viewer_ = 0;
  uint32_t followed_number_ = 0;

  std::shared_ptr<const ShownImage> image_;
  viewer::RenderThread renderer_;  ///< last: its thread ends first
};

}  // namespace relume::serve

// Messages of a viewer: JSON objects, whose field "do" names the kind. Everything in them is untrusted.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "core/vec.h"

namespace relume::serve {

/// The first message.
struct Hello {
  std::string token;
};
/// The frame with this number is displayed.
struct Acknowledge {
  uint32_t frame = 0;
};
/// Held fly keys, in force until the next such message, or for kHeld_s.
struct Fly {
  Vec3 axes{0};  ///< as in FlyInput, each in [-1, 1]
  bool fast = false;
};
struct Drag {
  bool pan = false;  ///< otherwise turns
  Vec2 by{0};        ///< in heights of the image
};
struct Wheel {
  float notches = 0;
};
struct ChangeSetting {
  int side = 0;  ///< 0: A, 1: B
  std::string name;
  std::string value;
};
struct ApplyPreset {
  int side = 0;
  std::string name;
};
struct ShowBuffer {
  std::string name;  ///< empty: the image
};
struct MoveSplit {
  float at = 0.5f;  ///< in widths of the image
};
/// The size of the page's area for the image, pixels.
struct Resize {
  int width = 0;
  int height = 0;
};
enum class BookmarkVerb : int { go, store, remove };
struct UseBookmark {
  BookmarkVerb verb = BookmarkVerb::go;
  int slot = 0;
};
enum class Button : int { pause, home, split, orbit, frame, animate, darker, brighter, copy, swap };
struct Press {
  Button button = Button::pause;
};
struct TakeScreenshot {};
struct RequestSteering {};
struct GrantSteering {
  uint32_t viewer = 0;
};
/// A heartbeat.
struct Still {};
/// The viewer left. No text parses to this.
struct Left {};

using MessageBody =
    std::variant<Hello, Acknowledge, Fly, Drag, Wheel, ChangeSetting, ApplyPreset, ShowBuffer, MoveSplit, Resize,
                 UseBookmark, Press, TakeScreenshot, RequestSteering, GrantSteering, Still, Left>;

struct Message {
  uint32_t number = 0;  ///< field "n"; frames name the newest that they follow
  MessageBody body = Still{};
};

/// Parses a message. Throws Error for other text: more than kMaxMessageBytes, nested objects, an unknown kind, missing
/// or unknown fields, and values out of range.
Message parse_message(std::string_view text);

/// Whether only the steering viewer may send it.
bool steers(const MessageBody& body);

}  // namespace relume::serve

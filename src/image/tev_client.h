// Shows images in a running tev viewer while they are rendered, through tev's TCP protocol [tev].
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "relume/image_io.h"

namespace relume {

struct TevAddress {
  std::string host;
  uint16_t port = 14158;  ///< tev's default
};

/// "HOST", "HOST:PORT" or "[IPV6]:PORT". Throws Error.
TevAddress parse_tev_address(const std::string& text);

struct TevTimeouts {
  std::chrono::milliseconds connect{3000};   ///< of the first connection
  std::chrono::milliseconds send{2000};      ///< of one message; a viewer that takes longer counts as gone
  std::chrono::milliseconds reconnect{200};  ///< of later connections, which a render waits for
  std::chrono::milliseconds retry{2000};     ///< between attempts to reconnect; doubles each time, up to a minute
};

/// One connection. Used by one thread at a time. Only the constructor throws because of the network: afterwards a lost
/// connection makes calls return false at once, and they try to reconnect (and create their images again) now and then.
class TevClient {
 public:
  /// Throws Error if nothing answers there in time.
  explicit TevClient(TevAddress address, TevTimeouts timeouts = {});
  ~TevClient();
  TevClient(TevClient&&) noexcept;
  TevClient& operator=(TevClient&&) noexcept;

  /// Opens a black image, replacing one of that name. Returns whether the viewer has it.
  bool create(const std::string& name, int width, int height, std::vector<std::string> channels);

  /// Sets the rectangle with top left corner (x, y). `values`: width · height pixels row by row, the channels of
  /// create() interleaved. Rectangle and count must fit the created image. Returns whether it was sent.
  bool update(const std::string& name, int x, int y, int width, int height, std::span<const float> values);

  /// The whole of an image that was created with three channels.
  bool update(const std::string& name, const Image& image);

  bool close(const std::string& name);

  bool connected() const;

  /// What happened to the connection since the last call, one sentence for a warning; empty: nothing new.
  std::string take_notice();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace relume

// Shows images in a running tev viewer during rendering, through tev's TCP protocol [tev].
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
  std::chrono::milliseconds connect{3000};   ///< for the first connection
  std::chrono::milliseconds send{2000};      ///< per message; a slower viewer counts as disconnected
  std::chrono::milliseconds reconnect{200};  ///< for later connections, which block the render
  std::chrono::milliseconds retry{2000};     ///< between attempts to reconnect; doubles each time, up to a minute
};

/// One connection, for one thread at a time. Only the constructor throws on network errors. After a lost connection,
/// calls return false at once. Occasionally one tries to reconnect and creates all images again.
class TevClient {
 public:
  /// Throws Error if the connection does not succeed in time.
  explicit TevClient(TevAddress address, TevTimeouts timeouts = {});
  ~TevClient();
  TevClient(TevClient&&) noexcept;
  TevClient& operator=(TevClient&&) noexcept;

  /// Opens a black image and replaces one with the same name. Returns whether it was sent.
  bool create(const std::string& name, int width, int height, std::vector<std::string> channels);

  /// Sets the rectangle with top left corner (x, y). `values`: width · height pixels row by row, with the channels of
  /// create() interleaved. Rectangle and count must fit the created image. Returns whether it was sent.
  bool update(const std::string& name, int x, int y, int width, int height, std::span<const float> values);

  /// Updates a whole image that was created with three channels.
  bool update(const std::string& name, const Image& image);

  bool close(const std::string& name);

  bool connected() const;

  /// Connection events since the last call, one sentence for a warning; empty: none.
  std::string take_notice();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace relume

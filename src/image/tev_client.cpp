// Contains relume's only use of POSIX sockets.
#include "image/tev_client.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <map>
#include <type_traits>
#include <utility>

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Operation codes of the protocol.
enum class Operation : uint8_t { close_image = 2, create_image = 4, update_image_v3 = 6 };

/// Pixels per message of a large update, which limits messages to about one megabyte.
constexpr size_t kPixelsPerMessage = size_t{1} << 16;
constexpr milliseconds kMaxRetry{60000};

/// uint32 length of the whole message, operation, then fields: little-endian numbers, zero-terminated strings.
class Message {
 public:
  explicit Message(Operation operation) {
    append(uint32_t{0});
    append(static_cast<uint8_t>(operation));
  }

  template <typename T>
  void append(T value) {
    static_assert(std::is_arithmetic_v<T> && std::endian::native == std::endian::little);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void append(const std::string& text) { bytes_.append(text.c_str(), std::strlen(text.c_str()) + 1); }
  void append(std::span<const float> values) {
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }

  /// Complete message; valid until the next append.
  std::span<const char> finish() {
    const auto length = static_cast<uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &length, sizeof(length));
    return bytes_;
  }

 private:
  std::string bytes_;
};

struct Resolved {
  sockaddr_storage address{};
  socklen_t length = 0;
};

std::vector<Resolved> resolve(const TevAddress& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  const int error = ::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &list);
  if (error != 0)
    throw Error(fmt::format("{}:{}: the host name cannot be resolved ({}); check the address of the viewer",
                            address.host, address.port, ::gai_strerror(error)));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> guard(list, &::freeaddrinfo);
  std::vector<Resolved> resolved;
  for (const addrinfo* a = list; a != nullptr; a = a->ai_next) {
    Resolved& r = resolved.emplace_back();
    std::memcpy(&r.address, a->ai_addr, a->ai_addrlen);
    r.length = a->ai_addrlen;
  }
  return resolved;
}

int remaining_ms(Clock::time_point deadline) {
  const auto left = std::chrono::ceil<milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::max<int64_t>(left, 0));
}

/// Whether `events` occur on the socket before the deadline.
bool wait_for(int socket, short events, Clock::time_point deadline) {
  for (;;) {
    pollfd p{socket, events, 0};
    const int ready = ::poll(&p, 1, remaining_ms(deadline));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

/// A non-blocking, connected socket, or -1 with errno set.
int connect_to(const Resolved& target, milliseconds timeout) {
  const int socket = ::socket(target.address.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0) return -1;
  const auto deadline = Clock::now() + timeout;
  int error = 0;
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&target.address), target.length) != 0) {
    error = errno;
    if (error == EINPROGRESS) {
      socklen_t length = sizeof(error);
      if (!wait_for(socket, POLLOUT, deadline)) {
        error = ETIMEDOUT;
      } else if (::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &length) != 0) {
        error = errno;
      }
    }
  }
  if (error == 0) {
    const int on = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    return socket;
  }
  ::close(socket);
  errno = error;
  return -1;
}

/// The viewer never sends data, so a readable socket has been closed by the viewer.
bool closed_by_viewer(int socket) {
  char byte = 0;
  const ssize_t count = ::recv(socket, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return count == 0 || (count < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}

bool send_all(int socket, std::span<const char> bytes, milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<size_t>(sent));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (!wait_for(socket, POLLOUT, deadline)) return false;
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

struct CreatedImage {
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;
};

Message create_message(const std::string& name, const CreatedImage& image) {
  Message message(Operation::create_image);
  message.append(uint8_t{1});  // grab focus
  message.append(name);
  message.append(int32_t{image.width});
  message.append(int32_t{image.height});
  message.append(static_cast<int32_t>(image.channels.size()));
  for (const std::string& channel : image.channels) message.append(channel);
  return message;
}

struct Rectangle {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

Message update_message(const std::string& name, const CreatedImage& image, const Rectangle& r,
                       std::span<const float> values) {
  const auto count = static_cast<int64_t>(image.channels.size());
  Message message(Operation::update_image_v3);
  message.append(uint8_t{0});  // keep the focus
  message.append(name);
  message.append(static_cast<int32_t>(count));
  for (const std::string& channel : image.channels) message.append(channel);
  for (const int32_t number : {r.x, r.y, r.width, r.height}) message.append(number);
  for (int64_t c = 0; c < count; ++c) message.append(c);      // offsets, in floats
  for (int64_t c = 0; c < count; ++c) message.append(count);  // strides
  message.append(values);
  return message;
}

}  // namespace

struct TevClient::State {
  TevAddress address;
  TevTimeouts timeouts;
  std::vector<Resolved> resolved;
  std::map<std::string, CreatedImage> images;
  int socket = -1;
  Clock::time_point next_attempt;
  milliseconds retry{0};
  std::string notice;

  ~State() { disconnect(); }

  std::string where() const { return fmt::format("{}:{}", address.host, address.port); }

  void disconnect() {
    if (socket >= 0) ::close(socket);
    socket = -1;
  }

  bool connect(milliseconds timeout) {
    for (const Resolved& target : resolved) {
      socket = connect_to(target, timeout);
      if (socket >= 0) return true;
    }
    return false;
  }

  void lose() {
    disconnect();
    retry = timeouts.retry;
    next_attempt = Clock::now() + retry;
    notice = fmt::format("{}: the connection to the viewer was lost; rendering continues without it", where());
  }

  bool send(Message message) {
    if (!closed_by_viewer(socket) && send_all(socket, message.finish(), timeouts.send)) return true;
    lose();
    return false;
  }

  /// Reconnects if the next attempt is due, and creates all images again.
  bool ensure_connected() {
    if (socket >= 0) return true;
    if (Clock::now() < next_attempt) return false;
    if (!connect(timeouts.reconnect)) {
      retry = std::min(2 * retry, kMaxRetry);
      next_attempt = Clock::now() + retry;
      return false;
    }
    notice = fmt::format("{}: reconnected to the viewer", where());
    for (const auto& [name, image] : images) {
      if (!send(create_message(name, image))) return false;
    }
    return true;
  }
};

TevAddress parse_tev_address(const std::string& text) {
  const auto fail = [&]() -> TevAddress {
    throw Error(fmt::format(
        "'{}' is not the address of a viewer; write HOST or HOST:PORT, for instance localhost:14158", text));
  };
  TevAddress address;
  std::string port;
  if (text.starts_with('[')) {
    const size_t end = text.find(']');
    if (end == std::string::npos || (end + 1 < text.size() && text[end + 1] != ':')) return fail();
    address.host = text.substr(1, end - 1);
    if (end + 1 < text.size()) port = text.substr(end + 1);
  } else {
    const size_t colon = text.find(':');
    address.host = text.substr(0, colon);
    if (colon != std::string::npos) port = text.substr(colon);
  }
  if (!port.empty()) {
    const char* end = port.data() + port.size();
    const auto [next, error] = std::from_chars(port.data() + 1, end, address.port);
    if (error != std::errc() || next != end || address.port == 0) return fail();
  }
  return address.host.empty() ? fail() : address;
}

TevClient::TevClient(TevAddress address, TevTimeouts timeouts) : state_(std::make_unique<State>()) {
  state_->address = std::move(address);
  state_->timeouts = timeouts;
  state_->resolved = resolve(state_->address);
  if (!state_->connect(timeouts.connect))
    throw Error(fmt::format("{}: no viewer answers ({}); start tev first, or check host and port", state_->where(),
                            std::strerror(errno)));
}

TevClient::~TevClient() = default;
TevClient::TevClient(TevClient&&) noexcept = default;
TevClient& TevClient::operator=(TevClient&&) noexcept = default;

bool TevClient::create(const std::string& name, int width, int height, std::vector<std::string> channels) {
  assert(width > 0 && height > 0 && !channels.empty());
  const bool was_connected = connected();
  CreatedImage& image = state_->images[name];
  image = {width, height, std::move(channels)};
  if (!state_->ensure_connected()) return false;
  return was_connected ? state_->send(create_message(name, image)) : true;  // a reconnection has created the image
}

bool TevClient::update(const std::string& name, int x, int y, int width, int height, std::span<const float> values) {
  const auto found = state_->images.find(name);
  if (found == state_->images.end()) return false;
  const CreatedImage& image = found->second;
  const size_t row = static_cast<size_t>(width) * image.channels.size();
  assert(x >= 0 && y >= 0 && x + width <= image.width && y + height <= image.height &&
         values.size() == row * static_cast<size_t>(height));
  if (!state_->ensure_connected()) return false;
  const int rows = static_cast<int>(std::max<size_t>(1, kPixelsPerMessage / static_cast<size_t>(std::max(width, 1))));
  for (int begin = 0; begin < height; begin += rows) {
    const int count = std::min(rows, height - begin);
    const auto part = values.subspan(row * static_cast<size_t>(begin), row * static_cast<size_t>(count));
    if (!state_->send(update_message(name, image, {x, y + begin, width, count}, part))) return false;
  }
  return true;
}

bool TevClient::update(const std::string& name, const Image& image) {
  static_assert(sizeof(Rgb) == 3 * sizeof(float));
  return update(name, 0, 0, image.width, image.height, {&image.pixels.data()->x, 3 * image.pixels.size()});
}

bool TevClient::close(const std::string& name) {
  state_->images.erase(name);
  if (!connected()) return false;
  Message message(Operation::close_image);
  message.append(name);
  return state_->send(std::move(message));
}

bool TevClient::connected() const { return state_->socket >= 0; }

std::string TevClient::take_notice() { return std::exchange(state_->notice, {}); }

}  // namespace relume

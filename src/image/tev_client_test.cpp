#include "image/tev_client.h"

#include <atomic>
#include <cstring>
#include <map>
#include <mutex>
#include <thread>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "relume/error.h"

namespace relume {
namespace {

using namespace std::chrono_literals;

struct ShownImage {
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;
  std::vector<std::vector<float>> planes;
};

/// Parses a message by the protocol; gtest failures report deviations.
class MessageReader {
 public:
  explicit MessageReader(std::vector<char> bytes) : bytes_(std::move(bytes)) {}

  template <typename T>
  T number() {
    T value{};
    EXPECT_LE(at_ + sizeof(T), bytes_.size());
    if (at_ + sizeof(T) > bytes_.size()) return value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  std::string text() {
    std::string result;
    for (char c = number<char>(); c != '\0'; c = number<char>()) result.push_back(c);
    return result;
  }
  std::vector<std::string> texts(int count) {
    std::vector<std::string> result;
    for (int i = 0; i < count; ++i) result.push_back(text());
    return result;
  }
  std::vector<float> rest() {
    std::vector<float> values((bytes_.size() - at_) / sizeof(float));
    EXPECT_EQ((bytes_.size() - at_) % sizeof(float), 0u);
    std::memcpy(values.data(), bytes_.data() + at_, values.size() * sizeof(float));
    return values;
  }

 private:
  std::vector<char> bytes_;
  size_t at_ = 0;
};

/// A viewer without a window that reconstructs the received images.
class FakeViewer {
 public:
  explicit FakeViewer(uint16_t port = 0) : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const int on = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    socklen_t length = sizeof(address);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), length), 0);
    EXPECT_EQ(::listen(listener_, 4), 0);
    EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &length), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~FakeViewer() {
    stop_ = true;
    thread_.join();
    ::close(listener_);
  }

  uint16_t port() const { return port_; }

  /// Returns the image once `pixels` pixels have arrived in total, or its state after some seconds.
  ShownImage wait_for(const std::string& name, size_t pixels) {
    for (int i = 0; i < 1000; ++i) {
      {
        const std::lock_guard lock(mutex_);
        if (pixels_received_ >= pixels && images_.count(name) != 0) return images_[name];
      }
      std::this_thread::sleep_for(5ms);
    }
    ADD_FAILURE() << "the image did not arrive";
    return {};
  }
  bool wait_until_closed(const std::string& name) {
    for (int i = 0; i < 1000; ++i) {
      {
        const std::lock_guard lock(mutex_);
        if (images_.count(name) == 0) return true;
      }
      std::this_thread::sleep_for(5ms);
    }
    return false;
  }

 private:
  static bool readable(int socket) {
    pollfd p{socket, POLLIN, 0};
    return ::poll(&p, 1, 10) > 0;
  }

  bool receive(int client, char* target, size_t count) {
    while (count > 0) {
      if (stop_) return false;
      if (!readable(client)) continue;
      const ssize_t n = ::recv(client, target, count, 0);
      if (n <= 0) return false;
      target += n;
      count -= static_cast<size_t>(n);
    }
    return true;
  }

  void serve() {
    while (!stop_) {
      if (!readable(listener_)) continue;
      const int client = ::accept(listener_, nullptr, nullptr);
      uint32_t length = 0;
      while (receive(client, reinterpret_cast<char*>(&length), sizeof(length))) {
        std::vector<char> message(length - sizeof(length));
        if (!receive(client, message.data(), message.size())) break;
        const std::lock_guard lock(mutex_);
        handle(MessageReader(std::move(message)));
      }
      ::close(client);
    }
  }

  void handle(MessageReader message) {
    switch (message.number<uint8_t>()) {
      case 2: images_.erase(message.text()); break;
      case 4: create(message); break;
      case 6: update(message); break;
      default: ADD_FAILURE() << "unknown operation";
    }
  }

  void create(MessageReader& message) {
    message.number<uint8_t>();
    ShownImage& image = images_[message.text()];
    image.width = message.number<int32_t>();
    image.height = message.number<int32_t>();
    image.channels = message.texts(message.number<int32_t>());
    image.planes.assign(image.channels.size(), std::vector<float>(static_cast<size_t>(image.width * image.height)));
  }

  void update(MessageReader& message) {
    message.number<uint8_t>();
    ShownImage& image = images_[message.text()];
    const auto count = static_cast<size_t>(message.number<int32_t>());
    EXPECT_EQ(message.texts(static_cast<int>(count)), image.channels);
    const auto x = message.number<int32_t>();
    const auto y = message.number<int32_t>();
    const auto width = message.number<int32_t>();
    const auto height = message.number<int32_t>();
    std::vector<int64_t> offsets(count);
    std::vector<int64_t> strides(count);
    for (int64_t& offset : offsets) offset = message.number<int64_t>();
    for (int64_t& stride : strides) stride = message.number<int64_t>();
    const std::vector<float> values = message.rest();
    for (size_t c = 0; c < count; ++c) {
      for (int i = 0; i < width * height; ++i) {
        const size_t target = static_cast<size_t>(int64_t{y + i / width} * image.width + x + i % width);
        image.planes[c].at(target) = values.at(static_cast<size_t>(offsets[c] + i * strides[c]));
      }
    }
    pixels_received_ += static_cast<size_t>(width * height);
  }

  int listener_;
  uint16_t port_ = 0;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::map<std::string, ShownImage> images_;
  size_t pixels_received_ = 0;
  std::thread thread_;
};

TEST(TevAddress, IsParsed) {
  EXPECT_EQ(parse_tev_address("box").host, "box");
  EXPECT_EQ(parse_tev_address("box").port, 14158);
  EXPECT_EQ(parse_tev_address("10.0.0.1:99").port, 99);
  EXPECT_EQ(parse_tev_address("[::1]:7").host, "::1");
  EXPECT_EQ(parse_tev_address("[::1]:7").port, 7);
  for (const char* bad : {"", ":80", "box:", "box:0", "box:70000", "box:x", "[::1", "[::1]7", "a:1:2"})
    EXPECT_THROW(parse_tev_address(bad), Error) << bad;
}

TEST(TevClient, ViewerRebuildsTheImage) {
  FakeViewer viewer;
  TevClient client({"127.0.0.1", viewer.port()});
  // Exceeds one message, so the viewer must combine bands.
  Image image(300, 500);
  for (size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = Rgb(static_cast<float>(i), 0.5f, -static_cast<float>(i));
  ASSERT_TRUE(client.create("render", 300, 500, {"R", "G", "B"}));
  ASSERT_TRUE(client.update("render", image));
  const std::vector<float> tile{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  ASSERT_TRUE(client.update("render", 298, 7, 2, 2, tile));
  image.at(298, 7) = {1, 2, 3};
  image.at(299, 7) = {4, 5, 6};
  image.at(298, 8) = {7, 8, 9};
  image.at(299, 8) = {10, 11, 12};
  const ShownImage shown = viewer.wait_for("render", 300 * 500 + 4);
  ASSERT_EQ(shown.channels, (std::vector<std::string>{"R", "G", "B"}));
  ASSERT_EQ(shown.width, 300);
  ASSERT_EQ(shown.height, 500);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) ASSERT_EQ(shown.planes[c][i], image.pixels[i][static_cast<int>(c)]) << i;
  }
  EXPECT_TRUE(client.close("render"));
  EXPECT_TRUE(viewer.wait_until_closed("render"));
  EXPECT_TRUE(client.take_notice().empty());
}

TEST(TevClient, AMissingViewerIsAnError) {
  uint16_t port = 0;
  {
    const FakeViewer viewer;
    port = viewer.port();
  }
  try {
    TevClient client({"127.0.0.1", port}, {.connect = 500ms});
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("start tev first"), std::string::npos) << e.what();
  }
  EXPECT_THROW(TevClient({"host.invalid", 1}), Error);
}

TEST(TevClient, ReportsALostConnectionOnceAndReconnects) {
  auto viewer = std::make_unique<FakeViewer>();
  const uint16_t port = viewer->port();
  TevClient client({"127.0.0.1", port}, {.retry = 20ms});
  ASSERT_TRUE(client.create("a", 1, 1, {"Y"}));
  viewer->wait_for("a", 0);
  viewer.reset();
  const std::vector<float> value{3.0f};
  EXPECT_FALSE(client.update("a", 0, 0, 1, 1, value));
  EXPECT_FALSE(client.connected());
  EXPECT_NE(client.take_notice().find("lost"), std::string::npos);
  EXPECT_FALSE(client.update("a", 0, 0, 1, 1, value));
  EXPECT_TRUE(client.take_notice().empty());
  FakeViewer again(port);
  bool sent = false;
  for (int i = 0; i < 500 && !sent; ++i) {
    std::this_thread::sleep_for(10ms);
    sent = client.update("a", 0, 0, 1, 1, value);
  }
  ASSERT_TRUE(sent);
  EXPECT_NE(client.take_notice().find("reconnected"), std::string::npos);
  EXPECT_EQ(again.wait_for("a", 1).planes.at(0).at(0), 3.0f);
}

TEST(TevClient, AViewerThatStopsReadingDoesNotStopTheRender) {
  // A listener that never accepts: the kernel completes the connection and fills its buffers.
  const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  ASSERT_EQ(::bind(listener, reinterpret_cast<sockaddr*>(&address), length), 0);
  ASSERT_EQ(::listen(listener, 1), 0);
  ASSERT_EQ(::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &length), 0);
  TevClient client({"127.0.0.1", ntohs(address.sin_port)}, {.send = 100ms, .retry = 60000ms});
  client.create("a", 2000, 2000, {"R", "G", "B"});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(client.update("a", Image(2000, 2000)));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 10s);  // far above the timeout, for slow machines
  ::close(listener);
}

}  // namespace
}  // namespace relume

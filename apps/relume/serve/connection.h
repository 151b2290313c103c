// A client's connection: an HTTP request, and possibly a WebSocket. Used only by the network's thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "serve/limits.h"
#include "serve/link_control.h"
#include "serve/message.h"
#include "serve/publisher.h"

namespace relume::serve {

struct EncodedImage;
class Network;

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(boost::asio::ip::tcp::socket socket, uint64_t id, std::string address, Network& network);

  void start();
  /// Closes at once. Pending operations end without effect.
  void close();
  /// Tells the viewer why, and closes.
  void leave(boost::beast::websocket::close_code code);
  /// Closes after a time-out; sends a ping when one is due.
  void check_times(double now_s);

  // Of viewers
  void tell(Topic topic, std::shared_ptr<const std::string> text);
  void show(std::shared_ptr<const EncodedImage> image);
  LinkControl& link() { return link_; }

  uint64_t id() const { return id_; }
  const std::string& address() const { return address_; }
  uint32_t viewer() const { return viewer_; }  ///< 0: not a viewer so far
  bool frame_waits() const { return frame_ != nullptr; }

  // Kept for the network
  int awaited_level = -1;      ///< of the requested image; -1: none
  uint64_t shown_version = 0;  ///< of the newest image that was sent or waits
  ScreenshotLimit screenshots;

 private:
  using WebSocket = boost::beast::websocket::stream<boost::beast::tcp_stream>;

  void read_request();
  void answer_request();
  void send_reply(unsigned status, std::string_view type, std::string_view body, bool is_head);
  void upgrade();
  void read_message();
  void take_message(size_t bytes);
  void greet(const Message& message);
  void write();
  void write_frame();
  void begin_write(size_t bytes, double now_s);
  void written(const boost::beast::error_code& failure);
  boost::asio::ip::tcp::socket& socket();

  Network& network_;
  uint64_t id_;
  std::string address_;
  std::optional<boost::beast::tcp_stream> stream_;  ///< before the upgrade
  std::optional<WebSocket> socket_;                 ///< after it
  boost::beast::flat_buffer buffer_{kMaxHeaderBytes + kMaxMessageBytes};
  std::optional<boost::beast::http::request_parser<boost::beast::http::empty_body>> parser_;
  std::optional<boost::beast::http::response<boost::beast::http::string_body>> reply_;

  uint32_t viewer_ = 0;
  bool opened_ = false;  ///< whether the WebSocket's handshake is complete
  bool closing_ = false;
  bool closed_ = false;
  double since_s_;  ///< start of the connection, or of closing
  double heard_s_;  ///< last message or pong
  double pinged_s_;
  bool pinging_ = false;  ///< whether a ping is in progress
  RateLimiter messages_{kMessagesPerSecond, kMessagesAtOnce};
  RateLimiter bytes_{kBytesPerSecond, kBytesAtOnce};
  RateLimiter controls_{kMessagesPerSecond, kMessagesAtOnce};  ///< pings, pongs
  LinkControl link_;

  // Only the newest of each waits.
  std::array<std::shared_ptr<const std::string>, kTopics> texts_;
  std::shared_ptr<const EncodedImage> frame_;
  std::shared_ptr<const EncodedImage> png_;
  bool writing_ = false;
  double writing_until_s_ = 0;           ///< time-out of the write in progress
  std::shared_ptr<const void> sending_;  ///< keeps the data of the write in progress
  std::array<uint8_t, 20> header_{};     ///< of the frame in progress
  uint32_t frames_ = 0;                  ///< sent
};

}  // namespace relume::serve

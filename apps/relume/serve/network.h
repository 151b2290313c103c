// All connections, and what they share. Except where noted, used only by the thread in run().
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "serve/allowed_hosts.h"
#include "serve/connection.h"
#include "serve/frame_encoder.h"
#include "serve/limits.h"
#include "serve/publisher.h"
#include "serve/server.h"
#include "serve/steering.h"

namespace relume::serve {

class Network {
 public:
  Network(const ServerOptions& options, Inbox& inbox);

  // By any thread
  int port() const { return port_; }
  void stop();
  void show(std::shared_ptr<const ShownImage> image);
  void tell(Topic topic, std::string text);

  /// Until stop().
  void run();

  // By connections
  const AllowedHosts& hosts() const { return hosts_; }
  bool knows_token(const std::string& token) const;
  bool has_room() const { return steering_.viewers().size() < most_viewers_; }
  /// Makes the connection a viewer. Returns its number.
  uint32_t join(const std::shared_ptr<Connection>& connection);
  void take(Connection& connection, const Message& message);
  void gone(Connection& connection);
  /// Requests the newest image for a viewer that lacks it, if its link has room.
  void offer_image(Connection& connection);

 private:
  void accept();
  void admit(boost::asio::ip::tcp::socket socket);
  void check_times();
  void send(const std::shared_ptr<const EncodedImage>& image);
  void take_screenshot(Connection& connection, double now_s);
  void tell_roles();
  void say_farewell();
  std::vector<std::shared_ptr<Connection>> connections() const;

  Inbox& inbox_;
  AllowedHosts hosts_;
  std::string token_;
  size_t most_viewers_;
  int port_ = 0;
  boost::asio::io_context io_{1};
  boost::asio::ip::tcp::acceptor acceptor_{io_};
  boost::asio::steady_timer accept_timer_{io_};
  boost::asio::steady_timer check_timer_{io_};
  boost::asio::steady_timer farewell_timer_{io_};
  RateLimiter accepts_{kAcceptedPerSecond, kAcceptedAtOnce};
  WaitingRoom waiting_;
  Steering steering_;
  std::map<uint64_t, std::shared_ptr<Connection>> connections_;
  uint64_t next_id_ = 1;
  uint32_t viewers_ = 0;  ///< ever
  RateLimiter screenshots_{kAllScreenshotsPerSecond, kAllScreenshotsAtOnce};
  std::array<std::shared_ptr<const std::string>, kTopics> texts_;
  std::string roles_;  ///< last told
  std::shared_ptr<const ShownImage> image_;
  FrameEncoder encoder_;  ///< last: its thread posts to the others
};

}  // namespace relume::serve

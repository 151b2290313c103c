#include "serve/network.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/asio/post.hpp>

#include "cli/console.h"
#include "core/clock.h"
#include "relume/error.h"
#include "serve/inbox.h"
#include "serve/token.h"

namespace relume::serve {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr double kCheck_s = 0.25;    // between checks of time-outs
constexpr double kFarewell_s = 0.2;  // for the last messages
constexpr double kNoSocket_s = 0.1;  // until the next attempt, if no file descriptor is free

std::chrono::steady_clock::duration seconds(double value) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(value));
}

std::string role_text(const Steering& steering, uint32_t viewer) {
  return fmt::format(R"({{"kind":"role","viewer":{},"steerer":{},"viewers":{},"requests":[{}]}})", viewer,
                     steering.steerer(), steering.viewers().size(), fmt::join(steering.requests(), ","));
}

/// `text`: a sentence of the server, without quotes.
std::string notice_text(const std::string& text) { return fmt::format(R"({{"kind":"notice","text":"{}"}})", text); }

}  // namespace

Network::Network(const ServerOptions& options, Inbox& inbox)
    : inbox_(inbox),
      hosts_(options.address, options.names),
      token_(options.token),
      most_viewers_(static_cast<size_t>(options.viewers)),
      encoder_([this](std::shared_ptr<const EncodedImage> image) {
        asio::post(io_, [this, image = std::move(image)] { send(image); });
      }) {
  error_code failure;
  const asio::ip::address address = asio::ip::make_address(options.address, failure);
  if (failure)
    throw Error(fmt::format("--bind is '{}', but must be a numeric address such as 127.0.0.1 or ::1", options.address));
  const tcp::endpoint endpoint(address, static_cast<uint16_t>(options.port));
  acceptor_.open(endpoint.protocol(), failure);
  if (!failure) acceptor_.set_option(asio::socket_base::reuse_address(true), failure);
  if (!failure) acceptor_.bind(endpoint, failure);
  if (!failure) acceptor_.listen(asio::socket_base::max_listen_connections, failure);
  if (failure)
    throw Error(fmt::format("cannot listen on {} port {}: {}; choose another with --port", options.address,
                            options.port, failure.message()));
  port_ = acceptor_.local_endpoint().port();
}

void Network::run() {
  accept();
  check_times();
  while (!io_.stopped()) {
    try {
      io_.run();
    } catch (const std::exception& error) {
      cli::warn(error.what());  // out of memory: other connections continue
    }
  }
}

void Network::stop() {
  asio::post(io_, [this] { say_farewell(); });
}

void Network::say_farewell() {
  error_code ignored;
  acceptor_.close(ignored);
  accept_timer_.cancel();
  check_timer_.cancel();
  for (const auto& connection : connections()) connection->leave(boost::beast::websocket::close_code::going_away);
  farewell_timer_.expires_after(seconds(kFarewell_s));
  farewell_timer_.async_wait([this](const error_code&) {
    for (const auto& connection : connections()) connection->close();
    io_.stop();
  });
}

void Network::show(std::shared_ptr<const ShownImage> image) {
  asio::post(io_, [this, image = std::move(image)] {
    image_ = image;
    for (const auto& connection : connections()) offer_image(*connection);
  });
}

void Network::tell(Topic topic, std::string text) {
  asio::post(io_, [this, topic, shared = std::make_shared<const std::string>(std::move(text))] {
    texts_[static_cast<size_t>(topic)] = shared;
    for (const auto& connection : connections()) {
      if (connection->viewer() != 0) connection->tell(topic, shared);
    }
  });
}

std::vector<std::shared_ptr<Connection>> Network::connections() const {
  std::vector<std::shared_ptr<Connection>> all;
  for (const auto& [id, connection] : connections_) all.push_back(connection);
  return all;
}

void Network::accept() {
  const double wait_s = accepts_.wait_s(1, now_s());
  if (wait_s > 0) {
    accept_timer_.expires_after(seconds(wait_s));
    return accept_timer_.async_wait([this](const error_code& failure) {
      if (!failure) accept();
    });
  }
  acceptor_.async_accept([this](const error_code& failure, tcp::socket socket) {
    if (!acceptor_.is_open()) return;
    if (failure) {
      accept_timer_.expires_after(seconds(kNoSocket_s));
      return accept_timer_.async_wait([this](const error_code& cancelled) {
        if (!cancelled) accept();
      });
    }
    accepts_.take(1, now_s());
    accept();  // first, since out of memory, admit() throws
    admit(std::move(socket));
  });
}

void Network::admit(tcp::socket socket) {
  error_code failure;
  const tcp::endpoint from = socket.remote_endpoint(failure);
  if (failure) return;  // it has left
  const auto connection =
      std::make_shared<Connection>(std::move(socket), next_id_++, from.address().to_string(), *this);
  connections_[connection->id()] = connection;
  if (const auto replaced = waiting_.enter(connection->id(), connection->address())) {
    if (const auto found = connections_.find(*replaced); found != connections_.end()) {
      const std::shared_ptr<Connection> oldest = found->second;
      oldest->close();
    }
  }
  connection->start();
}

void Network::check_times() {
  check_timer_.expires_after(seconds(kCheck_s));  // first, since the rest may throw
  check_timer_.async_wait([this](const error_code& failure) {
    if (!failure) check_times();
  });
  const double now = now_s();
  for (const auto& connection : connections()) connection->check_times(now);
  steering_.update(now);
  tell_roles();
}

bool Network::knows_token(const std::string& token) const { return equal_in_constant_time(token_, token); }

uint32_t Network::join(const std::shared_ptr<Connection>& connection) {
  waiting_.leave(connection->id());
  const uint32_t viewer = ++viewers_;
  steering_.join(viewer, now_s());
  inbox_.note_viewers(steering_.viewers().size());
  // Its first role tells it its number; tell_roles() informs the others.
  connection->tell(Topic::role, std::make_shared<const std::string>(role_text(steering_, viewer)));
  for (int topic = 0; topic < kTopics; ++topic) {
    const auto& text = texts_[static_cast<size_t>(topic)];
    if (text) connection->tell(static_cast<Topic>(topic), text);
  }
  asio::post(io_, [this, connection] {
    tell_roles();
    offer_image(*connection);
  });
  return viewer;
}

void Network::take(Connection& connection, const Message& message) {
  const double now = now_s();
  const uint32_t viewer = connection.viewer();
  if (const auto* ack = std::get_if<Acknowledge>(&message.body)) {
    connection.link().acknowledged(ack->frame, now);
    return offer_image(connection);
  }
  if (std::holds_alternative<TakeScreenshot>(message.body)) return take_screenshot(connection, now);
  if (std::holds_alternative<RequestSteering>(message.body)) {
    steering_.request(viewer, now);
    return tell_roles();
  }
  if (!steers(message.body) || !steering_.steers(viewer)) return;
  steering_.active(viewer, now);
  if (const auto* grant = std::get_if<GrantSteering>(&message.body)) {
    steering_.grant(viewer, grant->viewer, now);
    if (!steering_.steers(viewer)) inbox_.put({viewer, {0, Left{}}});
    return tell_roles();
  }
  inbox_.put({viewer, message});
}

void Network::take_screenshot(Connection& connection, double now_s) {
  const std::string refusal =
      image_ ? connection.screenshots.begin(screenshots_, now_s) : "there is no image so far; wait for the first one";
  if (refusal.empty()) return encoder_.request(image_, kPngLevel);
  connection.tell(Topic::notice, std::make_shared<const std::string>(notice_text(refusal)));
}

void Network::gone(Connection& connection) {
  waiting_.leave(connection.id());
  const uint32_t viewer = connection.viewer();
  if (viewer != 0) {
    steering_.leave(viewer, now_s());
    inbox_.note_viewers(steering_.viewers().size());
    inbox_.put({viewer, {0, Left{}}});
    tell_roles();
  }
  connections_.erase(connection.id());  // last: it may be the connection's last owner
}

void Network::offer_image(Connection& connection) {
  if (!image_ || connection.viewer() == 0 || connection.awaited_level >= 0 || connection.frame_waits()) return;
  if (connection.shown_version == image_->version) return;
  if (!connection.link().offer(image_->version, now_s())) return;
  connection.awaited_level = connection.link().level();
  encoder_.request(image_, connection.awaited_level);
}

void Network::send(const std::shared_ptr<const EncodedImage>& image) {
  for (const auto& connection : connections()) {
    if (!image) {
      connection->awaited_level = -1;
      connection->screenshots.end();
    } else if (image->level == kPngLevel) {
      if (connection->screenshots.end()) connection->show(image);
    } else if (connection->awaited_level == image->level) {
      connection->awaited_level = -1;
      connection->shown_version = image->version;
      connection->show(image);
      offer_image(*connection);
    }
  }
}

void Network::tell_roles() {
  std::string roles = role_text(steering_, 0);
  if (roles == roles_) return;
  roles_ = std::move(roles);
  for (const auto& connection : connections()) {
    if (connection->viewer() == 0) continue;
    connection->tell(Topic::role, std::make_shared<const std::string>(role_text(steering_, connection->viewer())));
  }
}

}  // namespace relume::serve

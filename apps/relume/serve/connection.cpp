#include "serve/connection.h"

#include <string>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>

#include "core/clock.h"
#include "relume/error.h"
#include "serve/frame_encoder.h"
#include "serve/network.h"
#include "serve/reply.h"

namespace relume::serve {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;

constexpr double kClosing_s = 1;

template <typename Text>
std::string_view view(const Text& text) {
  return {text.data(), text.size()};
}

}  // namespace

Connection::Connection(asio::ip::tcp::socket socket, uint64_t id, std::string address, Network& network)
    : network_(network),
      id_(id),
      address_(std::move(address)),
      stream_(std::in_place, std::move(socket)),
      since_s_(now_s()),
      heard_s_(since_s_),
      pinged_s_(since_s_) {}

asio::ip::tcp::socket& Connection::socket() { return socket_ ? socket_->next_layer().socket() : stream_->socket(); }

void Connection::start() {
  beast::error_code ignored;
  socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  read_request();
}

void Connection::close() {
  if (closed_) return;
  closed_ = true;
  beast::error_code ignored;
  socket().shutdown(asio::ip::tcp::socket::shutdown_both, ignored);
  socket().close(ignored);
  network_.gone(*this);
}

void Connection::leave(websocket::close_code code) {
  if (closed_ || closing_) return;
  if (!opened_) return close();
  closing_ = true;
  since_s_ = now_s();
  socket_->async_close(code, [self = shared_from_this()](const beast::error_code&) { self->close(); });
}

void Connection::check_times(double now_s) {
  if (closed_) return;
  if (closing_ ? now_s - since_s_ > kClosing_s : viewer_ == 0 && now_s - since_s_ > kHandshake_s) return close();
  if (writing_ && now_s > writing_until_s_) return close();
  if (viewer_ == 0 || closing_) return;
  if (now_s - heard_s_ > kIdle_s) return close();
  // Beast permits one ping at a time. It waits while a slow link takes a frame.
  if (pinging_ || now_s - pinged_s_ < kPing_s) return;
  pinging_ = true;
  pinged_s_ = now_s;
  socket_->async_ping({}, [self = shared_from_this()](const beast::error_code& failure) {
    self->pinging_ = false;
    if (failure) self->close();
  });
}

void Connection::read_request() {
  parser_.emplace();
  parser_->header_limit(kMaxHeaderBytes);
  parser_->body_limit(0);
  http::async_read(*stream_, buffer_, *parser_, [self = shared_from_this()](const beast::error_code& failure, size_t) {
    if (self->closed_) return;
    if (failure) return self->close();
    self->answer_request();
  });
}

void Connection::answer_request() {
  const auto& request = parser_->get();
  const auto header = [&](http::field field) {
    // Two headers of one name could be read in two ways.
    return request.count(field) == 1 ? view(request[field]) : std::string_view();
  };
  const std::string_view method = view(request.method_string());
  const Request parts{.method = method,
                      .target = view(request.target()),
                      .host = header(http::field::host),
                      .origin = header(http::field::origin),
                      .upgrades = websocket::is_upgrade(request)};
  const Reply reply = answer(parts, network_.hosts());
  if (reply.upgrades) return upgrade();
  send_reply(reply.status, reply.type, reply.body, method == "HEAD");
}

void Connection::send_reply(unsigned status, std::string_view type, std::string_view body, bool is_head) {
  reply_.emplace(static_cast<http::status>(status), 11);
  reply_->set(http::field::content_type, std::string(type));
  reply_->set(http::field::cache_control, "no-store");
  reply_->set("Content-Security-Policy", std::string(kContentSecurityPolicy));
  reply_->set("X-Content-Type-Options", "nosniff");
  reply_->set("Referrer-Policy", "no-referrer");
  reply_->set("Cross-Origin-Opener-Policy", "same-origin");
  reply_->set("Cross-Origin-Resource-Policy", "same-origin");
  reply_->keep_alive(false);
  reply_->body() = is_head ? std::string_view() : body;
  reply_->prepare_payload();
  http::async_write(*stream_, *reply_,
                    [self = shared_from_this()](const beast::error_code&, size_t) { self->close(); });
}

void Connection::upgrade() {
  socket_.emplace(std::move(*stream_));
  stream_.reset();
  socket_->read_message_max(kMaxMessageBytes);
  socket_->auto_fragment(false);  // one write per frame
  socket_->control_callback([this](websocket::frame_type, beast::string_view) {
    heard_s_ = now_s();
    if (controls_.take(1, heard_s_)) return;
    asio::post(socket_->get_executor(),
               [self = shared_from_this()] { self->leave(websocket::close_code::policy_error); });
  });
  socket_->async_accept(parser_->get(), [self = shared_from_this()](const beast::error_code& failure) {
    if (self->closed_) return;
    if (failure) return self->close();
    self->parser_.reset();
    self->buffer_.consume(self->buffer_.size());
    self->opened_ = true;
    self->read_message();
  });
}

void Connection::read_message() {
  socket_->async_read(buffer_, [self = shared_from_this()](const beast::error_code& failure, size_t bytes) {
    if (self->closed_) return;
    if (failure) return self->close();
    self->take_message(bytes);
    if (self->closed_ || self->closing_) return;
    self->buffer_.consume(self->buffer_.size());
    self->read_message();
  });
}

void Connection::take_message(size_t bytes) {
  if (closing_) return;
  heard_s_ = now_s();
  if (!messages_.take(1, heard_s_) || !bytes_.take(static_cast<double>(bytes), heard_s_))
    return leave(websocket::close_code::policy_error);
  if (!socket_->got_text()) return leave(websocket::close_code::unknown_data);
  try {
    const auto data = buffer_.data();
    const Message message = parse_message({static_cast<const char*>(data.data()), data.size()});
    if (viewer_ == 0) return greet(message);
    network_.take(*this, message);
  } catch (const Error&) {
    leave(websocket::close_code::bad_payload);
  }
}

void Connection::greet(const Message& message) {
  const auto* hello = std::get_if<Hello>(&message.body);
  if (hello == nullptr || !network_.knows_token(hello->token)) return leave(websocket::close_code::policy_error);
  if (!network_.has_room()) return leave(websocket::close_code::try_again_later);
  viewer_ = network_.join(shared_from_this());
}

void Connection::tell(Topic topic, std::shared_ptr<const std::string> text) {
  texts_[static_cast<size_t>(topic)] = std::move(text);
  write();
}

void Connection::show(std::shared_ptr<const EncodedImage> image) {
  (image->level == kPngLevel ? png_ : frame_) = std::move(image);
  write();
}

void Connection::write() {
  if (writing_ || closed_ || closing_ || !opened_) return;
  for (std::shared_ptr<const std::string>& text : texts_) {
    if (!text) continue;
    begin_write(text->size(), now_s());
    const auto data = asio::buffer(*text);
    sending_ = std::exchange(text, nullptr);
    socket_->text(true);
    return socket_->async_write(
        data, [self = shared_from_this()](const beast::error_code& failure, size_t) { self->written(failure); });
  }
  if (png_ || frame_) write_frame();
}

/// Slow links take large frames, too: only their acknowledgements can lower the level.
void Connection::begin_write(size_t bytes, double now_s) {
  writing_ = true;
  writing_until_s_ = now_s + kWrite_s + static_cast<double>(bytes) / kLeastBytesPerSecond;
}

void Connection::write_frame() {
  const bool is_png = png_ != nullptr;
  const std::shared_ptr<const EncodedImage> image = std::exchange(is_png ? png_ : frame_, nullptr);
  const double now = now_s();
  begin_write(image->bytes.size(), now);
  // Little-endian: kind, level, 2 bytes of padding, frame, input, width, height.
  const uint32_t input = image->viewer == viewer_ ? image->input : 0;
  const std::array<uint32_t, 5> words = {(is_png ? 1u : 0u) | static_cast<uint32_t>(image->level) << 8,
                                         is_png ? 0 : ++frames_, input, static_cast<uint32_t>(image->width),
                                         static_cast<uint32_t>(image->height)};
  for (size_t i = 0; i < header_.size(); ++i) header_[i] = static_cast<uint8_t>(words[i / 4] >> (8 * (i % 4)));
  if (!is_png) link_.sent(frames_, now);
  const std::array<asio::const_buffer, 2> data = {asio::buffer(header_), asio::buffer(image->bytes)};
  sending_ = image;
  socket_->binary(true);
  socket_->async_write(
      data, [self = shared_from_this()](const beast::error_code& failure, size_t) { self->written(failure); });
}

void Connection::written(const beast::error_code& failure) {
  writing_ = false;
  sending_.reset();
  if (closed_) return;
  if (failure) return close();
  write();
  network_.offer_image(*this);
}

}  // namespace relume::serve

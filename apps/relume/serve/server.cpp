#include "serve/server.h"

#include <utility>

#include "serve/network.h"

namespace relume::serve {

Server::Server(const ServerOptions& options, Inbox& inbox) : network_(std::make_unique<Network>(options, inbox)) {}

Server::~Server() { stop(); }

int Server::port() const { return network_->port(); }

void Server::start() {
  thread_ = std::thread([this] { network_->run(); });
}

void Server::stop() {
  if (!thread_.joinable()) return;
  network_->stop();
  thread_.join();
}

void Server::show(std::shared_ptr<const ShownImage> image) { network_->show(std::move(image)); }

void Server::tell(Topic topic, std::string text) { network_->tell(topic, std::move(text)); }

}  // namespace relume::serve

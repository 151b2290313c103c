// Serves the page and connects viewers, on a thread of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "serve/publisher.h"

namespace relume::serve {

class Inbox;
class Network;

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< numeric
  int port = 0;                       ///< 0: any free one
  std::vector<std::string> names;     ///< further ones in the header Host
  int viewers = 8;                    ///< at the same time
  std::string token;
};

class Server : public Publisher {
 public:
  /// Binds, without accepting so far. Throws Error. `inbox` outlives this object.
  Server(const ServerOptions& options, Inbox& inbox);
  ~Server() override;
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;
  /// Accepts connections from now on.
  void start();
  /// Tells viewers that the server ends, and closes all connections. Takes at most kFarewell_s.
  void stop();

  void show(std::shared_ptr<const ShownImage> image) override;
  void tell(Topic topic, std::string text) override;

 private:
  std::unique_ptr<Network> network_;
  std::thread thread_;
};

}  // namespace relume::serve

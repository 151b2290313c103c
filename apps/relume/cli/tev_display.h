// The image of a render in a tev viewer.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "cli/console.h"
#include "core/clock.h"
#include "image/tev_client.h"
#include "relume/session.h"

namespace relume::cli {

/// Sends the image to a tev viewer, if requested.
class TevDisplay {
 public:
  TevDisplay(const std::string& address, std::string name) : name_(std::move(name)) {
    if (!address.empty()) client_ = std::make_unique<TevClient>(parse_tev_address(address));
  }

  /// Sends the session's image.
  void show(const Session& session) {
    if (!client_) return;
    const Image image = session.image();
    if (!created_) client_->create(name_, image.width, image.height, {"R", "G", "B"});
    created_ = true;
    client_->update(name_, image);
    last_s_ = now_s();
    if (const std::string notice = client_->take_notice(); !notice.empty()) warn(notice);
  }

  /// Whether the last image is half a second old.
  bool due() const { return client_ && now_s() - last_s_ >= kInterval_s; }

 private:
  static constexpr double kInterval_s = 0.5;

  std::unique_ptr<TevClient> client_;
  std::string name_;
  bool created_ = false;
  double last_s_ = 0;
};

}  // namespace relume::cli

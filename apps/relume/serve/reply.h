// Answers to HTTP requests: embedded files by their exact names, and nothing else.
#pragma once

#include <string_view>

#include "serve/allowed_hosts.h"

namespace relume::serve {

/// A file of the page, embedded at build time.
struct PageFile {
  std::string_view target;  ///< "/main.js"
  std::string_view type;    ///< of its content
  std::string_view body;
};

/// The file of this exact target; nullptr if there is none.
const PageFile* find_page_file(std::string_view target);

/// Target of the WebSocket.
inline constexpr std::string_view kSocketTarget = "/socket";

/// Sent with every answer: the page runs its own scripts only, connects to this server only, and no page frames it.
inline constexpr std::string_view kContentSecurityPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The parts of a request that matter. Missing headers are empty.
struct Request {
  std::string_view method;
  std::string_view target;
  std::string_view host;
  std::string_view origin;
  bool upgrades = false;  ///< to a WebSocket
};

struct Reply {
  unsigned status = 404;
  std::string_view type = "text/plain; charset=utf-8";
  std::string_view body = {};  ///< empty for HEAD, too
  bool upgrades = false;       ///< the connection becomes a WebSocket
};

Reply answer(const Request& request, const AllowedHosts& hosts);

}  // namespace relume::serve

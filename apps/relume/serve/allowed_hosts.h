// Checks of the headers Host and Origin. A page of another site that rebinds its name to this machine sends that name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace relume::serve {

/// A name and a port of a URL or of the header Host.
struct HostPort {
  std::string host;  ///< lower case; IPv6 without brackets
  std::string port;  ///< empty: none
};

/// Parses "name", "name:port", "1.2.3.4:port" or "[::1]:port". Returns an empty host for other text.
HostPort parse_host(std::string_view text);

class AllowedHosts {
 public:
  /// `address`: numeric, to which the server binds. `names`: by which viewers may reach it through a proxy.
  AllowedHosts(const std::string& address, std::vector<std::string> names);

  /// Whether the header Host names this server: by a name of the loopback interface, by the address that it binds to,
  /// by any numeric address if it binds to all, or by one of the names. Any port, since ssh and proxies change it.
  bool allows_host(std::string_view host) const;
  /// Whether a page of this server sent the request: the header Origin has the scheme http or https, and names the same
  /// host and port as the header Host.
  bool allows_origin(std::string_view origin, std::string_view host) const;

 private:
  std::vector<std::string> names_;
  bool any_address_ = false;
};

/// Whether the numeric address belongs to the loopback interface.
bool is_loopback(const std::string& address);

}  // namespace relume::serve

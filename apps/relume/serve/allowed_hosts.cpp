#include "serve/allowed_hosts.h"

#include <algorithm>
#include <cctype>

#include <boost/asio/ip/address.hpp>

namespace relume::serve {
namespace {

constexpr size_t kMaxHost = 255;

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

bool is_name(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
  });
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

bool parse_address(const std::string& text, boost::asio::ip::address& address) {
  boost::system::error_code failure;
  address = boost::asio::ip::make_address(text, failure);
  return !failure;
}

}  // namespace

HostPort parse_host(std::string_view text) {
  if (text.empty() || text.size() > kMaxHost) return {};
  HostPort result;
  std::string_view rest;
  if (text.front() == '[') {
    const size_t end = text.find(']');
    if (end == std::string_view::npos) return {};
    boost::asio::ip::address address;
    result.host = lower(text.substr(1, end - 1));
    if (!parse_address(result.host, address) || !address.is_v6()) return {};
    rest = text.substr(end + 1);
  } else {
    const size_t colon = text.find(':');
    result.host = lower(text.substr(0, colon));
    if (!is_name(result.host)) return {};
    rest = colon == std::string_view::npos ? std::string_view() : text.substr(colon);
  }
  if (rest.empty()) return result;
  if (rest.front() != ':' || !is_port(rest.substr(1))) return {};
  result.port = rest.substr(1);
  return result;
}

bool is_loopback(const std::string& address) {
  boost::asio::ip::address parsed;
  return parse_address(address, parsed) && parsed.is_loopback();
}

AllowedHosts::AllowedHosts(const std::string& address, std::vector<std::string> names) : names_(std::move(names)) {
  for (std::string& name : names_) name = parse_host(name).host;  // without the brackets of IPv6
  for (const char* loopback : {"localhost", "127.0.0.1", "::1"}) names_.emplace_back(loopback);
  names_.push_back(lower(address));
  boost::asio::ip::address parsed;
  any_address_ = parse_address(address, parsed) && parsed.is_unspecified();
}

bool AllowedHosts::allows_host(std::string_view host) const {
  const HostPort parsed = parse_host(host);
  if (parsed.host.empty()) return false;
  if (std::find(names_.begin(), names_.end(), parsed.host) != names_.end()) return true;
  boost::asio::ip::address address;
  return any_address_ && parse_address(parsed.host, address);
}

bool AllowedHosts::allows_origin(std::string_view origin, std::string_view host) const {
  std::string_view rest = origin;
  if (rest.starts_with("http://")) {
    rest.remove_prefix(7);
  } else if (rest.starts_with("https://")) {
    rest.remove_prefix(8);
  } else {
    return false;
  }
  const HostPort from = parse_host(rest);
  const HostPort to = parse_host(host);
  return !from.host.empty() && from.host == to.host && from.port == to.port && allows_host(host);
}

}  // namespace relume::serve

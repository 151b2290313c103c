#include "ranks/hosts.h"

#include <fmt/format.h>

#include "ranks/launcher.h"

namespace relume::ranks {

Bytes hello_message(const std::string& identity) {
  return MessageWriter().put_text(host_name()).put_text(identity).take();
}

std::string HostList::add(const Message& hello) {
  MessageReader in(hello.content);
  hosts_[static_cast<size_t>(hello.from)] = in.get_text();
  if (in.get_text() == identity_) return {};
  return fmt::format(
      "{} has another version of relume, scene or settings than rank 0; give all ranks the same program and files",
      name_of(hello.from));
}

std::string HostList::name_of(int rank) const {
  const std::string& host = hosts_[static_cast<size_t>(rank)];
  return host.empty() ? fmt::format("rank {}", rank) : fmt::format("rank {} on {}", rank, host);
}

}  // namespace relume::ranks

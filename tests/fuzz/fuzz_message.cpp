// Fuzzes what clients of `relume serve` send: messages, and the parts of a request that decide its answer. Any bytes
// give a message, an answer or an Error. The first byte selects the kind.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "relume/error.h"
#include "serve/limits.h"
#include "serve/message.h"
#include "serve/model.h"
#include "serve/reply.h"
#include "serve/token.h"

namespace {

using namespace relume::serve;

constexpr std::string_view kSecret = "0123456789abcdef0123456789abcdef";

void read_message(const std::string& text) {
  const Message message = parse_message(text);
  if (const auto* set = std::get_if<ChangeSetting>(&message.body))
    check_page_value(relume::AllSettings(), set->name, set->value);
  if (const auto* hello = std::get_if<Hello>(&message.body)) {
    const bool equal = equal_in_constant_time(kSecret, hello->token);
    if (equal != (hello->token == kSecret)) std::abort();
  }
}

/// Lines: method, target, host, origin.
void read_request(std::string_view text, bool upgrades) {
  static const AllowedHosts hosts("127.0.0.1", {"render.example.com"});
  std::string_view parts[4];
  for (std::string_view& part : parts) {
    const size_t end = std::min(text.find('\n'), text.size());
    part = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  const Reply reply = answer({parts[0], parts[1], parts[2], parts[3], upgrades}, hosts);
  if (!reply.body.empty() && reply.status == 200 && find_page_file(parts[1]) == nullptr) std::abort();
  if (reply.upgrades && !hosts.allows_origin(parts[3], parts[2])) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    if (data[0] % 3 == 0) {
      read_message(text);
    } else {
      read_request(text, data[0] % 3 == 2);
    }
  } catch (const relume::Error&) {
    // Expected for invalid input.
  }
  return 0;
}

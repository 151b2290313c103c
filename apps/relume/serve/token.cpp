#include "serve/token.h"

#include <array>
#include <cerrno>
#include <cstdint>

#include <sys/random.h>

#include "relume/error.h"

namespace relume::serve {

std::string make_token() {
  std::array<uint8_t, 32> bytes{};
  size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t count = getrandom(bytes.data() + filled, bytes.size() - filled, 0);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) throw Error("the system provides no random numbers for the token; update the kernel");
    filled += static_cast<size_t>(count);
  }
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string token;
  for (const uint8_t byte : bytes) {
    token += kDigits[byte >> 4];
    token += kDigits[byte & 15];
  }
  return token;
}

bool equal_in_constant_time(std::string_view secret, std::string_view given) {
  // Neither the position nor the number of differing bytes affects the time: no branch depends on them.
  volatile uint8_t difference = secret.size() == given.size() && !secret.empty() ? 0 : 1;
  for (size_t i = 0; i < given.size(); ++i) {
    const char expected = secret.empty() ? '\0' : secret[i % secret.size()];
    difference = static_cast<uint8_t>(difference | static_cast<uint8_t>(expected ^ given[i]));
  }
  return difference == 0;
}

}  // namespace relume::serve

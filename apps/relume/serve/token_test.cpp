#include "serve/token.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/clock.h"

namespace relume::serve {
namespace {

TEST(Token, HasTwoHundredFiftySixRandomBits) {
  std::set<std::string> tokens;
  std::array<int, 16> digits{};
  for (int i = 0; i < 256; ++i) {
    const std::string token = make_token();
    ASSERT_EQ(token.size(), 64u);
    for (const char c : token) {
      ASSERT_TRUE(std::isxdigit(static_cast<unsigned char>(c)));
      ++digits[static_cast<size_t>(c <= '9' ? c - '0' : c - 'a' + 10)];
    }
    tokens.insert(token);
  }
  EXPECT_EQ(tokens.size(), 256u);
  // 16384 digits: 1024 of each on average, with a standard deviation of 31.
  for (const int count : digits) EXPECT_NEAR(count, 1024, 6 * 31);
}

TEST(Token, ComparesWholeTexts) {
  const std::string token = make_token();
  EXPECT_TRUE(equal_in_constant_time(token, token));
  EXPECT_FALSE(equal_in_constant_time(token, ""));
  EXPECT_FALSE(equal_in_constant_time(token, token.substr(1)));
  EXPECT_FALSE(equal_in_constant_time(token, token + token.front()));
  EXPECT_FALSE(equal_in_constant_time(token, token + token));
  EXPECT_FALSE(equal_in_constant_time("", ""));
  for (size_t i = 0; i < token.size(); ++i) {
    std::string other = token;
    other[i] = other[i] == 'a' ? 'b' : 'a';
    EXPECT_FALSE(equal_in_constant_time(token, other)) << i;
    std::string bit = token;
    bit[i] = static_cast<char>(bit[i] ^ static_cast<char>(0x80));
    EXPECT_FALSE(equal_in_constant_time(token, bit)) << i;
  }
}

/// Time of 20 comparisons, seconds.
double time_s(const std::string& secret, const std::string& given) {
  const double start_s = now_s();
  int equal = 0;
  for (int i = 0; i < 20; ++i) equal += equal_in_constant_time(secret, given) ? 1 : 0;
  EXPECT_EQ(equal, 0);
  return now_s() - start_s;
}

TEST(Token, TheTimeDoesNotShowWhereTextsDiffer) {
  const std::string secret(4096, 'a');
  std::string first = secret;
  std::string last = secret;
  first.front() = last.back() = 'b';
  // The shortest of many alternating measurements are undisturbed on a busy machine, too.
  double first_s = 1e9;
  double last_s = 1e9;
  for (int trial = 0; trial < 500; ++trial) {
    first_s = std::min(first_s, time_s(secret, first));
    last_s = std::min(last_s, time_s(secret, last));
  }
  const double ratio = first_s / last_s;
  // A comparison that stops at the first difference would be thousands of times faster.
  EXPECT_GT(ratio, 0.5);
  EXPECT_LT(ratio, 2.0);
}

}  // namespace
}  // namespace relume::serve

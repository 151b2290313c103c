// Feeds mutated messages to the parser: each gives a message within its limits or an Error, and little memory is used.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "cli/platform.h"
#include "relume/error.h"
#include "serve/limits.h"
#include "serve/message.h"
#include "serve/testing/example_messages.h"

namespace relume::serve {
namespace {

constexpr int kMessages = 20000;
#if defined(__SANITIZE_ADDRESS__)
constexpr uint64_t kMostGrowth = uint64_t{512} << 20;  // freed memory stays in quarantine
#else
constexpr uint64_t kMostGrowth = uint64_t{16} << 20;
#endif

/// Changes texts at random, with the same changes for the same seed everywhere.
class Mutator {
 public:
  explicit Mutator(uint32_t seed) : random_(seed) {}

  /// An example after up to four changes.
  std::string mutated() {
    std::string text = examples_[below(examples_.size())];
    for (size_t left = below(5); left > 0; --left) change(text);
    return text;
  }

 private:
  size_t below(size_t count) { return random_() % count; }

  void change(std::string& text) {
    const size_t at = below(text.size() + 1);
    switch (below(8)) {
      case 0: text.insert(at, 1, static_cast<char>(below(256))); return;
      case 1: text.erase(at, 1 + below(8)); return;
      case 2: text.insert(at, words_[below(words_.size())]); return;
      case 3: text.insert(at, text.substr(0, below(text.size() + 1))); return;
      case 4: text.insert(at, below(64), kSyntax[at % kSyntax.size()]); return;
      case 5: text.insert(at, kNumbers[below(kNumbers.size())]); return;
      case 6: text = text.substr(0, at) + examples_[below(examples_.size())].substr(at % 8); return;
      default: grow(text, at); return;
    }
  }

  /// Seldom, since long texts are slow: nested or many values, up to more than a message may have.
  void grow(std::string& text, size_t at) {
    if (below(16) > 0) {
      if (at < text.size()) text[at] = static_cast<char>(below(256));
      return;
    }
    const std::array<std::string, 4> parts = {"[", "{\"a\":", "1,", " "};
    const std::string& part = parts[below(parts.size())];
    std::string many;
    for (size_t size = below(2 * kMaxMessageBytes); many.size() < size;) many += part;
    text.insert(at, many);
  }

  static constexpr std::array<const char*, 8> kNumbers = {"-1",   "1e999",  "4294967296", "0.5",
                                                          "-0.0", "1e-400", "null",       "99999999999999999999"};
  static constexpr std::string_view kSyntax = "[{\"0,: ";
  std::mt19937 random_;
  std::vector<std::string> examples_ = testing::example_messages();
  std::vector<std::string> words_ = testing::example_words();
};

bool is_within(float value, float most) { return std::fabs(value) <= most; }

/// Whether all values are in the ranges that the parser promises.
struct Limits {
  bool operator()(const Hello& m) const { return m.token.size() <= 1024; }
  bool operator()(const Fly& m) const {
    return is_within(m.axes.x, 1) && is_within(m.axes.y, 1) && is_within(m.axes.z, 1);
  }
  bool operator()(const Drag& m) const { return is_within(m.by.x, 10) && is_within(m.by.y, 10); }
  bool operator()(const Wheel& m) const { return is_within(m.notches, 50); }
  bool operator()(const ChangeSetting& m) const {
    return (m.side == 0 || m.side == 1) && m.name.size() <= 1024 && m.value.size() <= 1024;
  }
  bool operator()(const ApplyPreset& m) const { return m.side == 0 || m.side == 1; }
  bool operator()(const MoveSplit& m) const { return m.at >= 0 && m.at <= 1; }
  bool operator()(const Resize& m) const {
    return std::min(m.width, m.height) >= 1 && std::max(m.width, m.height) <= 16384;
  }
  bool operator()(const UseBookmark& m) const { return m.slot >= 0 && m.slot <= 63; }
  bool operator()(const Left&) const { return false; }
  template <typename Other>
  bool operator()(const Other&) const {
    return true;
  }
};

TEST(MessageMutation, ExamplesAreOfEveryKind) {
  std::array<bool, std::variant_size_v<MessageBody>> found{};
  for (const std::string& text : testing::example_messages()) found[parse_message(text).body.index()] = true;
  found[MessageBody(Left{}).index()] = true;  // no text is
  EXPECT_EQ(std::count(found.begin(), found.end(), false), 0);
}

TEST(MessageMutation, GivesAMessageOrAnError) {
  Mutator mutator(20261);
  const uint64_t before = cli::peak_memory_bytes();
  int accepted = 0;
  int refused = 0;
  for (int i = 0; i < kMessages; ++i) {
    const std::string text = mutator.mutated();
    try {
      const Message message = parse_message(text);
      ++accepted;
      ASSERT_TRUE(std::visit(Limits(), message.body)) << text;
      ASSERT_LE(text.size(), kMaxMessageBytes);
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(accepted, kMessages / 10);  // a fifth is unchanged
  EXPECT_GT(refused, kMessages / 10);
  EXPECT_LE(cli::peak_memory_bytes(), before + kMostGrowth);
}

}  // namespace
}  // namespace relume::serve

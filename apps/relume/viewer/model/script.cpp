#include "viewer/model/script.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "relume/error.h"
#include "settings/text_list.h"

namespace relume::viewer {
namespace {

constexpr double kPatience_s = 300;  // time limit per frame, compilation of a large scene included
constexpr int kDragTicks = 12;       // frames of the interface per drag
constexpr int kMostFrames = 1'000'000;

struct Verb {
  std::string_view name;
  size_t fewest;  ///< minimum number of words
  bool rest;      ///< whether the last word is the rest of the line, for file names
};

constexpr std::array kVerbs = {
    Verb{"frames", 1, false},    Verb{"seconds", 1, false}, Verb{"loaded", 0, false}, Verb{"key", 1, false},
    Verb{"mouse", 2, false},     Verb{"drag", 4, false},    Verb{"click", 2, false},  Verb{"wheel", 1, false},
    Verb{"set", 2, true},        Verb{"set-b", 2, true},    Verb{"preset", 1, false}, Verb{"preset-b", 1, false},
    Verb{"buffer", 1, false},    Verb{"split", 1, false},   Verb{"panel", 1, false},  Verb{"select", 2, true},
    Verb{"drop", 1, true},       Verb{"sun", 1, false},     Verb{"save", 1, true},    Verb{"save-view", 1, true},
    Verb{"screenshot", 1, true}, Verb{"report", 0, false},  Verb{"pace", 1, false},   Verb{"emit", 1, false},
    Verb{"try", 2, true},        Verb{"play", 0, false},    Verb{"search", 1, true},
};

const Verb* find_verb(std::string_view name) {
  const auto* found = std::find_if(kVerbs.begin(), kVerbs.end(), [&](const Verb& v) { return v.name == name; });
  return found == kVerbs.end() ? nullptr : found;
}

std::string_view take_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(" \t"));
  text.remove_prefix(word.size());
  return word;
}

/// Parses a number of frames or ticks.
uint32_t count_in(const std::string& text) {
  const float value = number_in(text);
  if (!(value >= 0 && value <= kMostFrames))
    throw Error(fmt::format("'{}' is not a number from 0 to {}", text, kMostFrames));
  return static_cast<uint32_t>(value);
}

/// GLFW key codes (its input reference): letters and digits are ASCII.
const std::map<std::string, int, std::less<>>& key_codes() {
  static const std::map<std::string, int, std::less<>> codes = {
      {"space", 32}, {"[", 91},   {"]", 93},    {"escape", 256}, {"enter", 257}, {"tab", 258},
      {"home", 268}, {"f1", 290}, {"f12", 301}, {"shift", 340},  {"ctrl", 341},  {"alt", 342},
  };
  return codes;
}

}  // namespace

float number_in(const std::string& text) {
  float value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    throw Error("'" + text + "' is not a number");
  return value;
}

std::vector<ScriptStep> parse_script(std::string_view text, const std::string& place) {
  std::vector<ScriptStep> steps;
  for (int line = 1; !text.empty(); ++line) {
    const size_t end = std::min(text.find('\n'), text.size());
    std::string_view rest = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    rest = trimmed(rest.substr(0, rest.find('#')));
    if (rest.empty()) continue;
    ScriptStep step{line, std::string(take_word(rest)), {}};
    const Verb* verb = find_verb(step.verb);
    if (!verb)
      throw Error(fmt::format("{}:{}: there is no step '{}'; docs/viewer.md lists them", place, line, step.verb));
    while (!trimmed(rest).empty()) {
      const bool last = verb->rest && step.words.size() + 1 == verb->fewest;
      step.words.emplace_back(last ? trimmed(std::exchange(rest, {})) : take_word(rest));
    }
    if (step.words.size() < verb->fewest)
      throw Error(fmt::format("{}:{}: {} needs at least {} argument{}, but has {}; see docs/viewer.md", place, line,
                              step.verb, verb->fewest, verb->fewest == 1 ? "" : "s", step.words.size()));
    steps.push_back(std::move(step));
  }
  return steps;
}

std::vector<int> parse_keys(const std::string& text, const std::string& place) {
  std::vector<int> keys;
  std::string_view rest = text;
  while (!rest.empty()) {
    const size_t end = std::min(rest.find('+'), rest.size());
    const std::string name(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const auto found = key_codes().find(name);
    const bool plain = name.size() == 1 &&
                       (std::isdigit(static_cast<unsigned char>(name[0])) != 0 || (name[0] >= 'a' && name[0] <= 'z'));
    if (found == key_codes().end() && !plain)
      throw Error(fmt::format("{}: there is no key '{}'; docs/viewer.md lists them", place, name));
    keys.push_back(plain ? std::toupper(static_cast<unsigned char>(name[0])) : found->second);
  }
  return keys;
}

bool ScriptPlayer::perform_mouse(const ScriptStep& step) {
  input_.mouse = true;
  const Vec2 from(number_in(step.words[0]), number_in(step.words[1]));
  if (step.verb == "mouse") {
    input_.point = from;
    return true;
  }
  const bool drag = step.verb == "drag";
  const Vec2 to = drag ? Vec2(number_in(step.words[2]), number_in(step.words[3])) : from;
  const size_t keys_at = drag ? 4 : 2;
  input_.keys.clear();
  if (step.words.size() > keys_at) input_.keys = parse_keys(step.words[keys_at], place_);
  const int ticks = drag ? kDragTicks : 3;
  // One frame each: the mouse arrives, the button goes down, the mouse moves, the button goes up.
  const float t = clamp(static_cast<float>(tick_ - 2) / static_cast<float>(std::max(ticks - 4, 1)), 0, 1);
  input_.point = from + (to - from) * t;
  input_.left = tick_ >= 1 && tick_ < ticks - 1;
  if (tick_ < ticks) return false;
  input_.keys.clear();
  return true;
}

bool ScriptPlayer::wait_for_frames(uint64_t count, const ScriptTarget& target) {
  // Changes of earlier steps are requested at the end of this frame of the interface.
  if (tick_ == 0) return false;
  if (tick_ == 1) {
    request_ = target.request();
    following_ = 0;
  }
  if (following_ == 0) following_ = target.first_frame_following(request_);
  return following_ > 0 && target.frames() >= std::max(first_frame_ + count, following_ + count - 1);
}

bool ScriptPlayer::perform(const ScriptStep& step, const ScriptTarget& target) {
  if (step.verb == "frames") return wait_for_frames(count_in(step.words[0]), target);
  if (step.verb == "seconds") return target.now_s() >= begun_s_ + static_cast<double>(number_in(step.words[0]));
  if (step.verb == "loaded") return !target.loading();
  if (step.verb == "mouse" || step.verb == "drag" || step.verb == "click") return perform_mouse(step);
  if (step.verb == "wheel") {
    input_.wheel = tick_ == 0 ? number_in(step.words[0]) : 0;
    return tick_ > 0;
  }
  if (step.verb == "key") {
    const int held = step.words.size() > 1 ? static_cast<int>(count_in(step.words[1])) : 1;
    input_.keys = tick_ < held ? parse_keys(step.words[0], place_) : std::vector<int>{};
    return tick_ > held;  // one frame released, so that the next press counts
  }
  if (tick_ == 0) target.act(step);
  return step.verb != "screenshot" || tick_ > 0;  // taken when this frame of the interface is complete
}

void ScriptPlayer::update(const ScriptTarget& target) {
  while (!done()) {
    const ScriptStep& step = steps_[next_];
    const uint64_t frames = target.frames();
    if (tick_ == 0) {
      first_frame_ = frames;
      begun_s_ = target.now_s();
    }
    if (tick_ == 0 || frames != seen_frame_) progress_s_ = target.now_s();
    seen_frame_ = frames;
    try {
      if (!perform(step, target)) {
        ++tick_;
        const bool waits = step.verb == "seconds";
        if (!waits && target.now_s() - progress_s_ > kPatience_s)
          throw Error("no frame was rendered for five minutes; reduce --width and --height, or run on an idle machine");
        return;
      }
    } catch (const Error& error) {
      throw Error(fmt::format("{}:{}: {}: {}", place_, step.line, step.verb, error.what()));
    }
    tick_ = 0;
    ++next_;
  }
}

}  // namespace relume::viewer

#include "cli/frame_sequence.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "cli/command.h"
#include "render/render_settings.h"

namespace relume::cli {
namespace {

/// Removes the leading number of `text` and returns it.
std::optional<int> take_number(std::string_view& text) {
  int value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc{} || value < 0) return std::nullopt;
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return value;
}

struct Placeholder {
  size_t begin = 0;
  size_t length = 0;
  size_t digits = 0;
};

[[noreturn]] void refuse(const std::string& name) {
  throw UsageError(fmt::format("the file name '{}' must contain the frame number once, as ####, %d or %04d", name));
}

/// "%d", "%4d" or "%04d" at `begin`.
Placeholder percent_placeholder(const std::string& name, size_t begin) {
  std::string_view rest = std::string_view(name).substr(begin + 1);
  size_t digits = 1;
  if (!rest.starts_with('d')) {
    const std::optional<int> width = take_number(rest);
    if (!width || *width < 1 || *width > 20 || !rest.starts_with('d')) refuse(name);
    digits = static_cast<size_t>(*width);
  }
  return {begin, name.size() - begin - rest.size() + 1, digits};
}

std::optional<Placeholder> find_placeholder(const std::string& name) {
  const size_t begin = name.find_first_of("#%");
  if (begin == std::string::npos) return std::nullopt;
  Placeholder placeholder;
  if (name[begin] == '%') {
    placeholder = percent_placeholder(name, begin);
  } else {
    const size_t end = std::min(name.find_first_not_of('#', begin), name.size());
    placeholder = {begin, end - begin, end - begin};
  }
  if (name.find_first_of("#%", begin + placeholder.length) != std::string::npos) refuse(name);
  return placeholder;
}

}  // namespace

FrameRange parse_frame_range(std::string_view text, std::string_view place) {
  const UsageError error(fmt::format("{} is '{}', but must be two frame numbers such as 0-99", place, text));
  std::string_view rest = text;
  const std::optional<int> first = take_number(rest);
  if (!first) throw error;
  if (rest.empty()) return {*first, *first};
  rest.remove_prefix(rest.starts_with("..") ? 2 : rest.starts_with('-') ? 1 : 0);
  const std::optional<int> last = take_number(rest);
  if (!last || !rest.empty()) throw error;
  if (*last < *first) {
    throw UsageError(fmt::format("{} is '{}', but the first frame must not come after the last", place, text));
  }
  constexpr int kMostFrames = 1000000;  // more is a typing error
  if (*last - *first >= kMostFrames) {
    throw UsageError(fmt::format("{} is '{}', but a sequence has at most {} frames", place, text, kMostFrames));
  }
  return {*first, *last};
}

float frame_time_s(int frame, float fps, float scene_time_s) {
  const float time_s = scene_time_s + static_cast<float>(frame) / fps;
  if (time_s <= kLatestTime) return time_s;
  throw UsageError(
      fmt::format("--frames: frame {} would be at {:g} s, but times above {:g} s are not supported; give earlier "
                  "frames or a higher --fps",
                  frame, time_s, kLatestTime));
}

FrameNames::FrameNames(const std::filesystem::path& pattern)
    : folder_(pattern.parent_path()), before_(pattern.filename().string()) {
  if (const std::optional<Placeholder> placeholder = find_placeholder(before_)) {
    digits_ = placeholder->digits;
    after_ = before_.substr(placeholder->begin + placeholder->length);
    before_.resize(placeholder->begin);
  } else {
    after_ = pattern.extension().string();
    before_ = pattern.stem().string() + ".";
  }
}

std::filesystem::path FrameNames::operator()(int frame) const {
  return folder_ / fmt::format("{}{:0{}}{}", before_, frame, digits_, after_);
}

}  // namespace relume::cli

#include "image/rgbe.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>

#include <fmt/format.h>

#include "image/image_limits.h"
#include "relume/error.h"

namespace relume::detail {
namespace {

/// Four runs of 127 equal pixels take 8 bytes; a pixel decodes to 12. Old repeat counts may chain, but no encoder
/// writes such chains.
constexpr int64_t kMaxExpansion = 2048;

using Rgbe = std::array<uint8_t, 4>;

class RgbeParser {
 public:
  RgbeParser(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Image parse() {
    const ImageSize size = read_size();
    check_image_size(name_, size.width, size.height, sizeof(Rgb), bytes_.size(), kMaxExpansion);
    Image image(static_cast<int>(size.width), static_cast<int>(size.height));
    std::vector<Rgbe> row(static_cast<size_t>(image.width));
    for (int i = 0; i < image.height; ++i) {
      read_row(row);
      const int y = bottom_up_ ? image.height - 1 - i : i;
      for (int x = 0; x < image.width; ++x) image.at(x, y) = color_of(row[static_cast<size_t>(x)]);
    }
    return image;
  }

  ImageSize read_size() {
    read_header();
    return read_resolution();
  }

 private:
  [[noreturn]] void fail(const char* problem) const {
    throw Error(fmt::format("{}: damaged HDR image ({}); export or copy it again", name_, problem));
  }

  uint8_t byte() {
    if (position_ >= bytes_.size()) fail("it ends early");
    return std::to_integer<uint8_t>(bytes_[position_++]);
  }

  std::string line() {
    constexpr size_t kMaxLine = 4096;
    std::string text;
    for (char c = static_cast<char>(byte()); c != '\n'; c = static_cast<char>(byte())) {
      text.push_back(c);
      if (text.size() > kMaxLine) fail("its header has no end");
    }
    return text;
  }

  void read_header() {
    line();  // "#?RADIANCE"
    for (std::string text = line(); !text.empty(); text = line()) {
      if (text.starts_with("FORMAT=") && text != "FORMAT=32-bit_rle_rgbe")
        throw Error(fmt::format("{}: HDR images with '{}' are not supported; convert it to RGBE or EXR", name_, text));
      if (text.starts_with("EXPOSURE=")) read_exposure(std::string_view(text).substr(9));
    }
  }

  /// Reads a factor already applied to the radiance.
  void read_exposure(std::string_view text) {
    const size_t first = std::min(text.find_first_not_of(' '), text.size());
    float exposure = 0;
    const auto [end, error] = std::from_chars(text.data() + first, text.data() + text.size(), exposure);
    if (error == std::errc()) scale_ /= exposure;
    if (error != std::errc() || !std::isnormal(scale_) || scale_ < 0) fail("its exposure is not a positive number");
  }

  /// "-Y HEIGHT +X WIDTH": rows from the top; "+Y": from the bottom.
  ImageSize read_resolution() {
    const std::string text = line();
    std::string_view rest(text);
    const auto number_after = [&](std::string_view prefix) {
      if (!rest.starts_with(prefix)) fail("its resolution line is not '-Y height +X width'");
      rest.remove_prefix(prefix.size());
      int value = 0;
      const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
      if (error != std::errc()) fail("its resolution is not a number");
      rest.remove_prefix(static_cast<size_t>(end - rest.data()));
      return value;
    };
    bottom_up_ = rest.starts_with("+Y ");
    const int height = number_after(bottom_up_ ? "+Y " : "-Y ");
    const int width = number_after(" +X ");
    return {width, height};
  }

  void read_row(std::vector<Rgbe>& row) {
    const Rgbe first{byte(), byte(), byte(), byte()};
    const bool new_encoding = first[0] == 2 && first[1] == 2 && first[2] < 128;
    if (!new_encoding || row.size() < 8 || row.size() > 32767) return read_old_row(first, row);
    if (static_cast<size_t>(first[2] << 8 | first[3]) != row.size()) fail("a row has the wrong length");
    for (size_t channel = 0; channel < 4; ++channel) read_channel(channel, row);
  }

  /// Runs (count above 128, value) and literals (count, values …) of one channel of a row.
  void read_channel(size_t channel, std::vector<Rgbe>& row) {
    for (size_t x = 0; x < row.size();) {
      const uint8_t code = byte();
      const bool run = code > 128;
      const size_t count = run ? code - 128u : code;
      if (count == 0 || count > row.size() - x) fail("a run exceeds its row");
      const uint8_t value = run ? byte() : uint8_t{0};
      for (size_t i = 0; i < count; ++i) row[x++][channel] = run ? value : byte();
    }
  }

  /// Reads pixels, where (1, 1, 1, n) repeats the previous one n times; further such pixels extend the count by higher
  /// bytes.
  void read_old_row(Rgbe pixel, std::vector<Rgbe>& row) {
    int shift = 0;
    for (size_t x = 0; x < row.size();) {
      if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
        if (x == 0 || shift > 16) fail("a run exceeds its row");
        const size_t count = static_cast<size_t>(pixel[3]) << shift;
        if (count > row.size() - x) fail("a run exceeds its row");
        const Rgbe previous = row[x - 1];
        for (size_t i = 0; i < count; ++i) row[x++] = previous;
        shift += 8;
      } else {
        row[x++] = pixel;
        shift = 0;
      }
      if (x < row.size()) pixel = {byte(), byte(), byte(), byte()};
    }
  }

  Rgb color_of(const Rgbe& c) const {
    if (c[3] == 0) return Rgb(0);
    const float scale = std::ldexp(scale_, c[3] - 136);  // exponent bias 128, mantissas in 1/256
    return {static_cast<float>(c[0]) * scale, static_cast<float>(c[1]) * scale, static_cast<float>(c[2]) * scale};
  }

  std::span<const std::byte> bytes_;
  const std::string& name_;
  size_t position_ = 0;
  bool bottom_up_ = false;
  float scale_ = 1;  ///< radiance / stored value
};

}  // namespace

ImageSize rgbe_size(std::span<const std::byte> bytes, const std::string& name) {
  return RgbeParser(bytes, name).read_size();
}

Image parse_rgbe(std::span<const std::byte> bytes, const std::string& name) { return RgbeParser(bytes, name).parse(); }

}  // namespace relume::detail

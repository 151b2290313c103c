#include "files/bytes.h"

#include <array>
#include <cstdint>

#include <fmt/format.h>

#include "files/atomic_file.h"
#include "relume/error.h"

namespace relume {
namespace {

constexpr std::string_view kBase64Alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr std::array<int8_t, 256> base64_values() {
  std::array<int8_t, 256> values{};
  values.fill(-1);
  for (size_t i = 0; i < kBase64Alphabet.size(); ++i)
    values[static_cast<unsigned char>(kBase64Alphabet[i])] = static_cast<int8_t>(i);
  return values;
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

Bytes read_file_bytes(const std::filesystem::path& file, uint64_t max_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (error || !std::filesystem::exists(status))
    throw Error(ErrorCode::not_found, fmt::format("{}: the file does not exist; check its path", file.string()));
  if (!std::filesystem::is_regular_file(status))
    throw Error(fmt::format("{}: this is not a regular file; give the path of a file", file.string()));
  return read_file(file, max_bytes);
}

std::string missing_reason(const std::filesystem::path& file) {
  std::error_code failure;
  if (std::filesystem::exists(file, failure)) return {};
  return failure ? fmt::format("cannot be reached ({})", failure.message()) : "does not exist";
}

std::optional<Bytes> decode_base64(std::string_view text) {
  static constexpr std::array<int8_t, 256> kValues = base64_values();
  for (int i = 0; i < 2 && !text.empty() && text.back() == '='; ++i) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  Bytes bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const auto value = static_cast<int>(kValues[static_cast<unsigned char>(c)]);
    if (value < 0) return std::nullopt;
    bits = (bits << 6) | static_cast<uint32_t>(value);
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      bytes.push_back(static_cast<std::byte>((bits >> bit_count) & 0xffu));
    }
  }
  return bytes;
}

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

std::optional<Bytes> decode_data_uri(std::string_view uri) {
  const size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
  const std::string_view payload = uri.substr(comma + 1);
  if (uri.substr(0, comma).ends_with(";base64")) return decode_base64(payload);
  const std::string decoded = percent_decode(payload);
  const auto* first = reinterpret_cast<const std::byte*>(decoded.data());
  return Bytes(first, first + decoded.size());
}

std::string percent_decode(std::string_view text) {
  std::string decoded;
  decoded.reserve(text.size());
  for (size_t i = 0; i < text.size(); ++i) {
    const bool escape =
        text[i] == '%' && i + 2 < text.size() && hex_value(text[i + 1]) >= 0 && hex_value(text[i + 2]) >= 0;
    if (escape) {
      decoded.push_back(static_cast<char>(hex_value(text[i + 1]) * 16 + hex_value(text[i + 2])));
      i += 2;
    } else {
      decoded.push_back(text[i]);
    }
  }
  return decoded;
}

std::filesystem::path resolve_uri(const std::filesystem::path& base_dir, std::string_view uri,
                                  const std::string& place) {
  if (uri.find("://") != std::string_view::npos)
    throw Error(
        fmt::format("{}: '{}' is not a local file; download it and refer to it by a relative path", place, uri));
  if (uri.find('\0') != std::string_view::npos)
    throw Error(fmt::format("{}: a file name contains a zero byte; rename the file", place));
  return base_dir / std::filesystem::path(uri);
}

}  // namespace relume

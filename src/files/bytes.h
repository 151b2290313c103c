// Bytes of files and of URIs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace relume {

using Bytes = std::vector<std::byte>;

/// The whole file. Throws Error if it does not exist, is not a regular file (a device would never end) or cannot
/// be read.
Bytes read_file_bytes(const std::filesystem::path& file);

/// RFC 4648 with or without padding; nothing for any other character.
std::optional<Bytes> decode_base64(std::string_view text);

/// Whether `uri` starts with "data:".
bool is_data_uri(std::string_view uri);

/// Payload of "data:[type][;base64],…" (RFC 2397); nothing if it is malformed.
std::optional<Bytes> decode_data_uri(std::string_view uri);

/// Replaces %XX (RFC 3986); malformed escapes stay as they are.
std::string percent_decode(std::string_view text);

/// Path of a relative URI or path in a file that lies in `base_dir`. Throws Error with `place` for other schemes
/// (http: …), since nothing is fetched.
std::filesystem::path resolve_uri(const std::filesystem::path& base_dir, std::string_view uri,
                                  const std::string& place);

}  // namespace relume

// Bytes of files and URIs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace relume {

using Bytes = std::vector<std::byte>;

/// Reads the whole file. Throws Error if it does not exist, is not a regular file (devices may be endless), is larger
/// than `max_bytes` or cannot be read.
Bytes read_file_bytes(const std::filesystem::path& file, uint64_t max_bytes = uint64_t{1} << 33);

/// Reason why `file` cannot be found, for use after its name: "does not exist" or "cannot be reached (Permission
/// denied)"; empty if it exists.
std::string missing_reason(const std::filesystem::path& file);

/// Decodes RFC 4648 with or without padding; std::nullopt for any other character.
std::optional<Bytes> decode_base64(std::string_view text);

/// Whether `uri` starts with "data:".
bool is_data_uri(std::string_view uri);

/// Payload of "data:[type][;base64],…" (RFC 2397); std::nullopt if malformed.
std::optional<Bytes> decode_data_uri(std::string_view uri);

/// Replaces %XX (RFC 3986); keeps malformed escapes.
std::string percent_decode(std::string_view text);

/// Path of a relative URI or path in a file in `base_dir`. Throws Error with `place` for other schemes (http: …), which
/// are never fetched.
std::filesystem::path resolve_uri(const std::filesystem::path& base_dir, std::string_view uri,
                                  const std::string& place);

}  // namespace relume

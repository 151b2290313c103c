// Files that gzip may have compressed (RFC 1952).
#pragma once

#include <filesystem>
#include <string>

#include "files/bytes.h"

namespace relume {

/// Whether the name ends in ".gz".
bool is_gzip_name(const std::filesystem::path& file);

/// The uncompressed bytes; `bytes` themselves without the signature of gzip. Throws Error for damaged data, and for
/// more than 64 MiB plus 200 times the compressed size: no real file shrinks that much, but files made to exhaust
/// memory do.
Bytes gunzipped(Bytes bytes, const std::string& place);

}  // namespace relume

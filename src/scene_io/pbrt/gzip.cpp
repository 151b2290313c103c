#include "scene_io/pbrt/gzip.h"

#include <algorithm>

#include <fmt/format.h>
#include <zlib.h>

#include "files/extension.h"
#include "relume/error.h"

namespace relume {
namespace {

constexpr size_t kFreeBytes = size_t{64} << 20;
constexpr size_t kMaxRatio = 200;
constexpr size_t kChunk = size_t{1} << 20;

/// zlib's state of a decompression.
class Inflater {
 public:
  explicit Inflater(Bytes& input) {
    constexpr int kGzip = 16 + MAX_WBITS;
    stream_.next_in = reinterpret_cast<Bytef*>(input.data());
    stream_.avail_in = static_cast<uInt>(input.size());
    is_ready_ = inflateInit2(&stream_, kGzip) == Z_OK;
  }
  ~Inflater() {
    if (is_ready_) inflateEnd(&stream_);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// Appends up to kChunk bytes to `out`. Returns zlib's status.
  int step(Bytes& out) {
    if (!is_ready_) return Z_MEM_ERROR;
    const size_t before = out.size();
    out.resize(before + kChunk);
    stream_.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream_.avail_out = static_cast<uInt>(kChunk);
    const int status = inflate(&stream_, Z_NO_FLUSH);
    out.resize(before + kChunk - stream_.avail_out);
    return status;
  }

 private:
  z_stream stream_ = {};
  bool is_ready_ = false;
};

}  // namespace

bool is_gzip_name(const std::filesystem::path& file) { return lower_extension(file) == ".gz"; }

Bytes gunzipped(Bytes bytes, const std::string& place) {
  if (bytes.size() < 2 || bytes[0] != std::byte{0x1f} || bytes[1] != std::byte{0x8b}) return bytes;
  if (bytes.size() > 0xffffffffu)
    throw Error(fmt::format("{}: compressed files above 4 GiB are not supported; decompress it", place));
  const size_t limit = kFreeBytes + kMaxRatio * bytes.size();
  Inflater inflater(bytes);
  Bytes out;
  for (;;) {
    const int status = inflater.step(out);
    if (status == Z_STREAM_END) return out;
    if (status != Z_OK) throw Error(fmt::format("{}: the gzip data are damaged; copy the file again", place));
    if (out.size() > limit)
      throw Error(fmt::format("{}: the file grows to more than {} times its size; decompress it", place, kMaxRatio));
  }
}

}  // namespace relume

#include "render/checkpoint.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <span>
#include <sstream>
#include <stdexcept>
#include <streambuf>
#include <vector>

#include <fmt/format.h>

#include "core/fnv1a.h"
#include "core/stream_io.h"
#include "files/atomic_file.h"
#include "relume/error.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr char kMagic[8] = {'r', 'e', 'l', 'u', 'm', 'e', 'C', 'C'};

/// Forwards bytes to another buffer and computes their checksum.
class SummingBuffer final : public std::streambuf {
 public:
  explicit SummingBuffer(std::streambuf* target) : target_(target) {}
  uint64_t checksum() const { return checksum_.value(); }

 protected:
  std::streamsize xsputn(const char* bytes, std::streamsize size) override {
    checksum_.add(bytes, static_cast<size_t>(size));
    return target_->sputn(bytes, size);
  }
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    const char byte = traits_type::to_char_type(c);
    return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
  }

 private:
  std::streambuf* target_;
  Fnv1a checksum_;
};

void write_bytes(std::ostream& out, std::span<const std::byte> bytes) {
  write_value(out, static_cast<uint64_t>(bytes.size()));
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}
void write_text(std::ostream& out, const std::string& text) { write_bytes(out, std::as_bytes(std::span(text))); }

const std::string kEndOfBuffers = "end of buffers";
const std::string kEndOfFile = "end";

struct LoadedBuffer {
  Buffer* target;
  std::vector<std::byte> now;
  std::vector<std::byte> previous;
};

class Reader {
 public:
  Reader(std::istream& in, const std::filesystem::path& file) : in_(in), file_(file) {}
  void get(void* data, size_t size) {
    if (!in_.read(static_cast<char*>(data), static_cast<std::streamsize>(size))) damaged();
  }
  template <typename T>
  T get() {
    T value;
    get(&value, sizeof(T));
    return value;
  }
  std::string get_text() {
    const auto size = get<uint64_t>();
    if (size > (1u << 20)) damaged();
    std::string text(size, '\0');
    get(text.data(), size);
    return text;
  }
  /// Throws unless the stored size is `size`.
  std::vector<std::byte> get_bytes(uint64_t size) {
    if (get<uint64_t>() != size) damaged();
    std::vector<std::byte> bytes(size);
    get(bytes.data(), size);
    return bytes;
  }
  /// Throws unless the checksum of the rest of the file is valid. Must precede any use of the data.
  void check_rest(Fnv1a checksum) {
    const auto here = in_.tellg();
    in_.seekg(0, std::ios::end);
    auto left = static_cast<int64_t>(in_.tellg() - here) - static_cast<int64_t>(sizeof(uint64_t));
    if (left < 0) damaged();
    in_.seekg(here);
    std::vector<char> block(size_t{1} << 20);
    while (left > 0) {
      const auto size = static_cast<size_t>(std::min(left, static_cast<int64_t>(block.size())));
      get(block.data(), size);
      checksum.add(block.data(), size);
      left -= static_cast<int64_t>(size);
    }
    if (get<uint64_t>() != checksum.value()) damaged();
    in_.seekg(here);
  }
  [[noreturn]] void damaged() const {
    throw Error(fmt::format("{}: the checkpoint is damaged or incomplete; delete it to start over", file_.string()));
  }

 private:
  std::istream& in_;
  const std::filesystem::path& file_;
};

/// First line that differs between two texts of settings: "seed": 3, now "seed": 4.
std::string first_difference(const std::string& then, const std::string& now) {
  std::istringstream a(then);
  std::istringstream b(now);
  const auto next = [](std::istringstream& in) {
    std::string line;
    std::getline(in, line);
    const size_t first = line.find_first_not_of(' ');
    if (first == std::string::npos) return std::string();
    const size_t last = line.find_last_not_of(" ,");
    return line.substr(first, last - first + 1);
  };
  while (a || b) {
    const std::string before = next(a);
    const std::string after = next(b);
    if (before != after)
      return before.empty() ? "without " + after : before + ", now " + (after.empty() ? "absent" : after);
  }
  return "unnamed settings differ";
}

void check_header(Reader& reader, const std::filesystem::path& file, const CheckpointHeader& expected) {
  char magic[sizeof(kMagic)];
  reader.get(magic, sizeof(magic));
  if (std::memcmp(magic, kMagic, sizeof(magic)) != 0)
    throw Error(
        fmt::format("{}: this is not a checkpoint of this version of relume; delete it to start over, or name "
                    "another file",
                    file.string()));
  Fnv1a checksum;
  checksum.add(magic, sizeof(magic));
  reader.check_rest(checksum);
  if (reader.get<uint64_t>() != expected.scene_hash)
    throw Error(fmt::format("{}: the checkpoint belongs to another scene; delete it to start over", file.string()));
  const std::string settings = reader.get_text();
  if (settings != expected.settings) {
    throw Error(fmt::format("{}: the checkpoint was made with other settings ({}); use those or delete it",
                            file.string(), first_difference(settings, expected.settings)));
  }
}

bool plausible(const Counters& counters) {
  RenderSettings settings;
  const SettingList list = describe(settings);
  const SettingTraits& time = require_setting(list, "scene-time", "").traits;
  const auto in_range = [&](float time_s) { return time_s >= time.min && time_s <= time.max; };
  return counters.since_change <= counters.sequence_age && counters.sequence_age <= counters.frames &&
         counters.image_frames <= counters.frames && counters.image_paths <= counters.paths &&
         in_range(counters.time_s) && in_range(counters.previous_time_s) && in_range(counters.stretch_time_s);
}

}  // namespace

std::string checkpoint_key(const RenderSettings& settings) {
  RenderSettings relevant = settings;
  relevant.threads = 0;
  relevant.scalar_kernels = false;
  relevant.device = "cpu";
  relevant.time_s = 0;
  const PixelWindow& crop = settings.crop;
  const SampleSettings& samples = settings.samples;
  return settings_to_json(describe(relevant)) + (samples.sums ? "\nexact sums" : "") +
         (settings.auxiliary ? "\nauxiliary buffers" : "") +
         (samples.first > 0 ? fmt::format("\nsamples from {}", samples.first) : "") +
         (crop.empty() ? "" : fmt::format("\ncrop {},{},{},{}", crop.x, crop.y, crop.width, crop.height));
}

void write_checkpoint(const std::filesystem::path& file, const CheckpointHeader& header, const BufferTable& buffers,
                      const Pipeline& pipeline) {
  AtomicFile target(file);
  SummingBuffer summing(target.stream().rdbuf());
  std::ostream out(&summing);
  write_value(out, kMagic);
  write_value(out, header.scene_hash);
  write_text(out, header.settings);
  write_value(out, header.counters);
  for (const auto& buffer : buffers.all()) {
    if (!buffer->description().persistent) continue;
    write_text(out, std::string(buffer->name()));
    write_bytes(out, buffer->bytes());
    write_bytes(out, buffer->previous_bytes());
  }
  write_text(out, kEndOfBuffers);
  pipeline.save(out);
  write_text(out, kEndOfFile);
  write_value(target.stream(), summing.checksum());
  if (!out) target.stream().setstate(std::ios::badbit);
  target.commit();
}

Counters read_checkpoint(const std::filesystem::path& file, const CheckpointHeader& expected, BufferTable& buffers,
                         Pipeline& pipeline) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error(fmt::format("{}: the checkpoint cannot be opened; check its permissions", file.string()));
  Reader reader(in, file);
  check_header(reader, file, expected);
  const auto counters = reader.get<Counters>();
  if (!plausible(counters)) reader.damaged();
  std::vector<LoadedBuffer> loaded;
  for (std::string name = reader.get_text(); name != kEndOfBuffers; name = reader.get_text()) {
    Buffer* buffer = buffers.find(name);
    if (!buffer) reader.damaged();
    std::vector<std::byte> now = reader.get_bytes(buffer->bytes().size());
    loaded.push_back({buffer, std::move(now), reader.get_bytes(buffer->previous_bytes().size())});
  }
  try {
    pipeline.load(in);
  } catch (const std::length_error&) {  // numbers of elements that no array can hold
    reader.damaged();
  }
  if (!in || reader.get_text() != kEndOfFile) reader.damaged();
  for (const LoadedBuffer& l : loaded) {
    std::memcpy(l.target->bytes().data(), l.now.data(), l.now.size());
    if (!l.previous.empty()) std::memcpy(l.target->previous_bytes().data(), l.previous.data(), l.previous.size());
  }
  return counters;
}

}  // namespace relume

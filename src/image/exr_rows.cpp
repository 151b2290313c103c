#include "image/exr_rows.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>

#include "files/atomic_file.h"
#include "files/bytes.h"
#include "image/exr_header.h"
#include "image/openexr/streams.h"

namespace relume {
namespace {

/// Headers of relume's files are smaller; those of other files may be refused.
constexpr size_t kMaxHeaderBytes = size_t{1} << 20;

class FileInput : public Imf::IStream {
 public:
  FileInput(std::ifstream& stream, const std::string& name) : IStream(name.c_str()), stream_(stream) {}

  bool read(char* target, int count) override {
    if (!stream_.read(target, count)) throw Error("the file ends early");
    const bool has_more = stream_.peek() != std::ifstream::traits_type::eof();
    stream_.clear();  // at the end, tellg() would fail
    return has_more;
  }
  uint64_t tellg() override { return static_cast<uint64_t>(std::streamoff(stream_.tellg())); }
  void seekg(uint64_t position) override {
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(position));
  }
  void clear() override { stream_.clear(); }

 private:
  std::ifstream& stream_;
};

/// Opens the file and checks its header.
std::ifstream open_checked(const std::filesystem::path& file) {
  const std::string name = file.string();
  if (const std::string reason = missing_reason(file); !reason.empty())
    throw Error(fmt::format("{}: the file {}; check its name", name, reason));
  std::error_code failure;
  const uint64_t size = std::filesystem::is_regular_file(file, failure) ? std::filesystem::file_size(file, failure) : 0;
  std::ifstream stream(file, std::ios::binary);
  if (failure || !stream)
    throw Error(fmt::format("{}: the file cannot be opened; check its permissions, and the limit of open files", name));
  std::vector<std::byte> head(std::min<uint64_t>(size, kMaxHeaderBytes));
  stream.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(stream.gcount()));
  stream.clear();
  stream.seekg(0);
  detail::check_exr_header(head, name, size);
  return stream;
}

PixelWindow window_of(const Imath::Box2i& data, const Imath::Box2i& display) {
  return {data.min.x - display.min.x, data.min.y - display.min.y, data.max.x - data.min.x + 1,
          data.max.y - data.min.y + 1};
}

Imf::PixelType pixel_type(const ExrRowChannel& channel) { return channel.is_integer ? Imf::UINT : Imf::FLOAT; }

/// Memory of `rows` for the library, whose slices are not const even for output.
Imf::FrameBuffer frame_buffer(const ExrLayout& layout, const Imath::Box2i& rows, uint32_t* words) {
  const auto width = static_cast<size_t>(rows.max.x - rows.min.x + 1);
  const size_t plane = width * static_cast<size_t>(rows.max.y - rows.min.y + 1);
  Imf::FrameBuffer buffer;
  for (size_t c = 0; c < layout.channels.size(); ++c) {
    const ExrRowChannel& channel = layout.channels[c];
    buffer.insert(channel.name, Imf::Slice::Make(pixel_type(channel), words + c * plane, rows, sizeof(uint32_t),
                                                 sizeof(uint32_t) * width));
  }
  return buffer;
}

size_t word_count(const ExrLayout& layout, int rows) {
  return layout.channels.size() * static_cast<size_t>(layout.window.width) * static_cast<size_t>(rows);
}

}  // namespace

struct ExrRowReader::State {
  explicit State(const std::filesystem::path& file)
      : name(file.string()), stream(open_checked(file)), input(stream, name) {}

  std::string name;
  std::ifstream stream;
  FileInput input;
  std::unique_ptr<Imf::InputFile> exr;
  Imath::Box2i data;
  ExrLayout layout;
};

ExrRowReader::ExrRowReader(const std::filesystem::path& file) : state_(std::make_unique<State>(file)) {
  State& s = *state_;
  try {
    s.exr = std::make_unique<Imf::InputFile>(s.input);
    const Imf::Header& header = s.exr->header();
    s.data = header.dataWindow();
    const Imath::Box2i& display = header.displayWindow();
    s.layout.width = display.max.x - display.min.x + 1;
    s.layout.height = display.max.y - display.min.y + 1;
    s.layout.window = window_of(s.data, display);
    s.layout.attributes = detail::string_attributes(header);
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      if (c.channel().xSampling != 1 || c.channel().ySampling != 1) throw Error("a channel is subsampled");
      s.layout.channels.push_back({c.name(), c.channel().type == Imf::UINT});
    }
    if (!s.exr->isComplete()) throw Error("the file ends early");
  } catch (const std::exception& e) {
    detail::fail_damaged(s.name, e);
  }
}

ExrRowReader::~ExrRowReader() = default;
ExrRowReader::ExrRowReader(ExrRowReader&&) noexcept = default;
ExrRowReader& ExrRowReader::operator=(ExrRowReader&&) noexcept = default;

const ExrLayout& ExrRowReader::layout() const { return state_->layout; }

void ExrRowReader::read(int first, int count, std::span<uint32_t> words) {
  State& s = *state_;
  if (words.size() != word_count(s.layout, count)) throw std::logic_error("rows need memory of their size");
  const Imath::Box2i rows({s.data.min.x, s.data.min.y + first}, {s.data.max.x, s.data.min.y + first + count - 1});
  try {
    s.exr->setFrameBuffer(frame_buffer(s.layout, rows, words.data()));
    s.exr->readPixels(rows.min.y, rows.max.y);
  } catch (const std::exception& e) {
    detail::fail_damaged(s.name, e);
  }
}

struct ExrRowWriter::State {
  State(const std::filesystem::path& file, const ExrLayout& wanted)
      : name(file.string()), layout(wanted), target(file), stream(target.stream(), name) {}

  std::string name;
  ExrLayout layout;
  AtomicFile target;
  detail::StreamOutput stream;
  std::unique_ptr<Imf::OutputFile> exr;

  /// Calls a function of the library, and reports its error.
  template <typename F>
  void attempt(const F& function) {
    try {
      function();
    } catch (const std::exception& e) {
      target.close();  // throws if the file itself failed
      detail::fail_write(name, e);
    }
  }
};

ExrRowWriter::ExrRowWriter(const std::filesystem::path& file, const ExrLayout& layout) {
  std::set<std::string_view> names;
  for (const ExrRowChannel& channel : layout.channels) {
    if (channel.name.empty() || !names.insert(channel.name).second)
      throw Error(fmt::format("{}: two channels have the name '{}'; use different names", file.string(), channel.name));
  }
  state_ = std::make_unique<State>(file, layout);
  State& s = *state_;
  s.attempt([&] {
    const PixelWindow& w = layout.window;
    Imf::Header header({{0, 0}, {layout.width - 1, layout.height - 1}},
                       Imath::Box2i({w.x, w.y}, {w.x + w.width - 1, w.y + w.height - 1}));
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities());  // the default is Rec. 709
    for (const auto& [key, value] : layout.attributes) header.insert(key, Imf::StringAttribute(value));
    for (const ExrRowChannel& channel : layout.channels)
      header.channels().insert(channel.name, Imf::Channel(pixel_type(channel)));
    s.exr = std::make_unique<Imf::OutputFile>(s.stream, header);
  });
}

ExrRowWriter::~ExrRowWriter() {
  // The library writes the table of rows into the stream.
  if (state_) state_->exr.reset();
}

void ExrRowWriter::write(int count, std::span<const uint32_t> words) {
  State& s = *state_;
  if (words.size() != word_count(s.layout, count)) throw std::logic_error("rows need memory of their size");
  s.attempt([&] {
    const PixelWindow& w = s.layout.window;
    const int y = s.exr->currentScanLine();
    const Imath::Box2i rows({w.x, y}, {w.x + w.width - 1, y + count - 1});
    s.exr->setFrameBuffer(frame_buffer(s.layout, rows, const_cast<uint32_t*>(words.data())));
    s.exr->writePixels(count);
  });
}

void ExrRowWriter::commit() {
  state_->attempt([&] { state_->exr.reset(); });
  state_->target.commit();
}

}  // namespace relume

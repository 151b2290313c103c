// EXR through the OpenEXR library: reads from memory, writes to AtomicFile.
#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fmt/format.h>

#include "files/atomic_file.h"
#include "image/exr_header.h"
#include "image/image_complete.h"
#include "image/openexr/streams.h"
#include "relume/error.h"
#include "relume/image_io.h"

namespace relume {
namespace {

using detail::fail_damaged;
using detail::fail_write;
using detail::StreamOutput;
using detail::string_attributes;

class MemoryInput : public Imf::IStream {
 public:
  MemoryInput(std::span<const std::byte> bytes, const std::string& name) : IStream(name.c_str()), bytes_(bytes) {}

  bool read(char* target, int count) override {
    if (count < 0 || static_cast<uint64_t>(count) > bytes_.size() - position_) throw Error("the file ends early");
    std::memcpy(target, bytes_.data() + position_, static_cast<size_t>(count));
    position_ += static_cast<uint64_t>(count);
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override {
    if (position > bytes_.size()) throw Error("the file ends early");
    position_ = position;
  }

 private:
  std::span<const std::byte> bytes_;
  uint64_t position_ = 0;
};

/// Lets the library compress and decompress large images on all cores; no effect for small ones.
void enable_threads(int64_t pixel_count) {
  if (pixel_count < (int64_t{1} << 20)) return;
  static std::once_flag once;
  std::call_once(once, [] {
    if (Imf::globalThreadCount() == 0)
      Imf::setGlobalThreadCount(static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
  });
}

int64_t pixel_count(const Imath::Box2i& box) {
  return (int64_t{box.max.x} - box.min.x + 1) * (int64_t{box.max.y} - box.min.y + 1);
}

/// Samples of one channel over the data window, before the conversion to the display window.
struct Plane {
  std::string name;
  int x_sampling = 1;
  int y_sampling = 1;
  int row_length = 0;
  std::vector<float> samples;
};

std::vector<Plane> read_planes(Imf::InputFile& file, const Imath::Box2i& data) {
  std::vector<Plane> planes;
  Imf::FrameBuffer frame_buffer;
  const Imf::ChannelList& channels = file.header().channels();
  const int width = data.max.x - data.min.x + 1;
  const int height = data.max.y - data.min.y + 1;
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    const Imf::Channel& channel = c.channel();
    Plane& plane = planes.emplace_back();
    plane.name = c.name();
    plane.x_sampling = channel.xSampling;
    plane.y_sampling = channel.ySampling;
    plane.row_length = width / channel.xSampling;
    plane.samples.resize(static_cast<size_t>(plane.row_length) * static_cast<size_t>(height / channel.ySampling));
  }
  for (Plane& plane : planes) {
    const size_t stride = sizeof(float) * static_cast<size_t>(plane.row_length);
    frame_buffer.insert(plane.name, Imf::Slice::Make(Imf::FLOAT, plane.samples.data(), data, sizeof(float), stride,
                                                     plane.x_sampling, plane.y_sampling));
  }
  file.setFrameBuffer(frame_buffer);
  file.readPixels(data.min.y, data.max.y);
  return planes;
}

/// Samples over the display window: replicated if subsampled, 0 outside the data window.
std::vector<float> over_display_window(Plane&& plane, const Imath::Box2i& data, const Imath::Box2i& display) {
  if (data == display && plane.x_sampling == 1 && plane.y_sampling == 1) return std::move(plane.samples);
  const auto width = static_cast<size_t>(int64_t{display.max.x} - display.min.x + 1);
  std::vector<float> values(static_cast<size_t>(pixel_count(display)), 0.0f);
  const int x_begin = std::max(data.min.x, display.min.x);
  const int x_end = std::min(data.max.x, display.max.x);
  for (int y = std::max(data.min.y, display.min.y); y <= std::min(data.max.y, display.max.y); ++y) {
    const size_t source_row =
        static_cast<size_t>((y - data.min.y) / plane.y_sampling) * static_cast<size_t>(plane.row_length);
    float* target = values.data() + static_cast<size_t>(y - display.min.y) * width;
    for (int x = x_begin; x <= x_end; ++x)
      target[x - display.min.x] = plane.samples[source_row + static_cast<size_t>((x - data.min.x) / plane.x_sampling)];
  }
  return values;
}

/// Part of the display window that the data window covers; empty if it covers all or nothing.
PixelWindow overlap(const Imath::Box2i& data, const Imath::Box2i& display) {
  const Imath::V2i first(std::max(data.min.x, display.min.x), std::max(data.min.y, display.min.y));
  const Imath::V2i last(std::min(data.max.x, display.max.x), std::min(data.max.y, display.max.y));
  const bool is_whole = first == display.min && last == display.max;
  if (is_whole || last.x < first.x || last.y < first.y) return {};
  return {first.x - display.min.x, first.y - display.min.y, last.x - first.x + 1, last.y - first.y + 1};
}

struct Windows {
  Imath::Box2i data;
  Imath::Box2i display;
};

/// Reads the windows from the header.
Windows read_windows(std::span<const std::byte> bytes, const std::string& name) {
  detail::check_exr_header(bytes, name);
  try {
    MemoryInput input(bytes, name);
    const Imf::InputFile file(input);
    return {file.header().dataWindow(), file.header().displayWindow()};
  } catch (const std::exception& e) {
    fail_damaged(name, e);
  }
}

void check_writable(const std::string& name, const ExrFile& exr) {
  if (exr.width <= 0 || exr.height <= 0 || exr.channels.empty())
    throw Error(
        fmt::format("{}: an image of {}x{} pixels and {} channels cannot be written; it needs at least one of each",
                    name, exr.width, exr.height, exr.channels.size()));
  const PixelWindow& w = exr.data_window;
  if (w.x < 0 || w.y < 0 || w.width < 0 || w.height < (w.empty() ? 0 : 1) || w.width > exr.width - w.x ||
      w.height > exr.height - w.y)
    throw Error(fmt::format("{}: the data window {},{},{},{} lies outside the image of {}x{} pixels; make it smaller",
                            name, w.x, w.y, w.width, w.height, exr.width, exr.height));
  const size_t count = static_cast<size_t>(exr.width) * static_cast<size_t>(exr.height);
  std::set<std::string_view> names;
  for (const ExrChannel& channel : exr.channels) {
    if (channel.values.size() != count)
      throw Error(fmt::format("{}: channel '{}' has {} values for {} pixels; give it one value per pixel", name,
                              channel.name, channel.values.size(), count));
    if (channel.name.empty() || !names.insert(channel.name).second)
      throw Error(fmt::format("{}: two channels have the name '{}'; use different names", name, channel.name));
  }
}

Imath::Box2i data_window(const ExrFile& exr) {
  const PixelWindow& w = exr.data_window;
  if (w.empty()) return {{0, 0}, {exr.width - 1, exr.height - 1}};
  return {{w.x, w.y}, {w.x + w.width - 1, w.y + w.height - 1}};
}

Imf::Header make_header(const ExrFile& exr) {
  Imf::Header header({{0, 0}, {exr.width - 1, exr.height - 1}}, data_window(exr));
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::addChromaticities(header, Imf::Chromaticities());  // the default is Rec. 709
  for (const auto& [key, value] : exr.attributes) header.insert(key, Imf::StringAttribute(value));
  for (const ExrChannel& channel : exr.channels) header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
  return header;
}

}  // namespace

const ExrChannel* ExrFile::find(std::string_view name) const {
  const auto found =
      std::find_if(channels.begin(), channels.end(), [&](const ExrChannel& c) { return c.name == name; });
  return found == channels.end() ? nullptr : &*found;
}

ExrFile parse_exr(std::span<const std::byte> bytes, const std::string& name) {
  detail::check_exr_header(bytes, name);
  try {
    MemoryInput input(bytes, name);
    Imf::InputFile file(input);
    const Imath::Box2i data = file.header().dataWindow();
    const Imath::Box2i display = file.header().displayWindow();
    enable_threads(pixel_count(data));
    ExrFile exr;
    exr.width = display.max.x - display.min.x + 1;
    exr.height = display.max.y - display.min.y + 1;
    exr.attributes = string_attributes(file.header());
    exr.data_window = overlap(data, display);
    for (Plane& plane : read_planes(file, data)) {
      std::string plane_name = plane.name;
      exr.channels.push_back({std::move(plane_name), over_display_window(std::move(plane), data, display)});
    }
    return exr;
  } catch (const std::exception& e) {
    fail_damaged(name, e);
  }
}

PixelWindow stored_window(std::span<const std::byte> bytes, const std::string& name) {
  if (!detail::starts_with(bytes, "\x76\x2f\x31\x01")) return {};
  const Windows windows = read_windows(bytes, name);
  return overlap(windows.data, windows.display);
}

detail::ImageSize detail::exr_size(std::span<const std::byte> bytes, const std::string& name) {
  const Imath::Box2i display = read_windows(bytes, name).display;
  return {int64_t{display.max.x} - display.min.x + 1, int64_t{display.max.y} - display.min.y + 1};
}

ExrFile read_exr(const std::filesystem::path& file) { return parse_exr(read_file(file), file.string()); }

void write_exr(const std::filesystem::path& file, const ExrFile& exr) {
  check_writable(file.string(), exr);
  AtomicFile target(file);
  try {
    enable_threads(static_cast<int64_t>(exr.width) * exr.height);
    StreamOutput stream(target.stream(), file.string());
    Imf::OutputFile output(stream, make_header(exr));
    Imf::FrameBuffer frame_buffer;
    for (const ExrChannel& channel : exr.channels) {
      // The library's slices are not const, but output only reads them.
      char* base = reinterpret_cast<char*>(const_cast<float*>(channel.values.data()));
      frame_buffer.insert(channel.name,
                          Imf::Slice(Imf::FLOAT, base, sizeof(float), sizeof(float) * static_cast<size_t>(exr.width)));
    }
    output.setFrameBuffer(frame_buffer);
    output.writePixels(data_window(exr).size().y + 1);
  } catch (const std::exception& e) {
    target.close();  // throws if the file itself failed
    fail_write(file.string(), e);
  }
  target.commit();
}

}  // namespace relume

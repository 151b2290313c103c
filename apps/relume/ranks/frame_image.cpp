#include "ranks/frame_image.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/image.h"
#include "core/fnv1a.h"
#include "files/atomic_file.h"
#include "files/extension.h"
#include "framebuffer/ocio_view.h"
#include "framebuffer/tone_map.h"
#include "ranks/frame_job.h"
#include "relume/error.h"
#include "render/display.h"

namespace relume::ranks {
namespace {

/// First member of the checkpoint of a sequence.
constexpr const char* kSequence = "relume.sequence";

Image image_of(const ExrFile& exr) {
  Image image(exr.width, exr.height);
  for (int c = 0; c < 3; ++c) {
    const ExrChannel* const channel = exr.find(std::string(1, "RGB"[c]));
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i][c] = channel->values[i];
  }
  return cli::part_of(image, exr.data_window);
}

std::string hash_of(const std::string& text) {
  Fnv1a hash;
  hash.add(text.data(), text.size());
  return fmt::format("{:016x}", hash.value());
}

}  // namespace

Bytes to_message(const FrameImage& frame) {
  MessageWriter out;
  out.put(static_cast<uint64_t>(frame.index)).put(frame.samples).put(frame.render_s).put(frame.rays);
  out.put(frame.in_studio).put(frame.exr.width).put(frame.exr.height).put(frame.exr.data_window);
  out.put(static_cast<uint64_t>(frame.exr.attributes.size()));
  for (const auto& [name, text] : frame.exr.attributes) out.put_text(name).put_text(text);
  out.put(static_cast<uint64_t>(frame.exr.channels.size()));
  for (const ExrChannel& channel : frame.exr.channels)
    out.put_text(channel.name).put_bytes(std::as_bytes(std::span(channel.values)));
  return out.take();
}

FrameImage frame_of_message(const Bytes& bytes) {
  MessageReader in(bytes);
  FrameImage frame;
  frame.index = in.get<uint64_t>();
  frame.samples = in.get<double>();
  frame.render_s = in.get<double>();
  frame.rays = in.get<uint64_t>();
  frame.in_studio = in.get<bool>();
  frame.exr.width = in.get<int>();
  frame.exr.height = in.get<int>();
  frame.exr.data_window = in.get<PixelWindow>();
  for (auto left = in.get<uint64_t>(); left > 0; --left) {
    std::string name = in.get_text();
    frame.exr.attributes[std::move(name)] = in.get_text();
  }
  const size_t pixels = static_cast<size_t>(frame.exr.width) * static_cast<size_t>(frame.exr.height);
  for (auto left = in.get<uint64_t>(); left > 0; --left) {
    ExrChannel channel{in.get_text(), std::vector<float>(pixels)};
    const std::span<const std::byte> values = in.get_bytes(pixels * sizeof(float));
    std::memcpy(channel.values.data(), values.data(), values.size());
    frame.exr.channels.push_back(std::move(channel));
  }
  return frame;
}

bool is_sequence_file(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line(std::string_view(kSequence).size() + 2, '\0');
  return stream.read(line.data(), static_cast<std::streamsize>(line.size())) &&
         line == fmt::format("{{\"{}", kSequence);
}

FrameWriter::FrameWriter(const cli::RenderOptions& options, const cli::RenderSetup& setup, std::string identity)
    : options_(options),
      setup_(setup),
      identity_(
          hash_of(fmt::format("{} {} {} {}", identity, setup.plan.frames.first, options.fps, setup.scene_time_s))) {}

void FrameWriter::resume() {
  const std::string& file = options_.checkpoint;
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  const auto json = nlohmann::json::parse(text.str(), nullptr, false);
  const bool is_valid =
      json.is_object() && json.value(kSequence, "") != "" && json.contains("next") && json["next"].is_number_unsigned();
  if (!is_valid) {
    throw Error(
        fmt::format("{}: this is no checkpoint of a sequence on several ranks; name another file, or delete it", file));
  }
  if (json.value(kSequence, "") != identity_)
    throw Error(
        fmt::format("{}: the checkpoint belongs to another scene, settings or frames; use those, or delete it", file));
  next_ = std::min(json["next"].get<size_t>(), setup_.plan.files.size());
  if (json.contains("exposure") && json["exposure"].is_number()) exposure_ = json["exposure"].get<float>();
  check_earlier_images(setup_.plan, next_, file);
}

size_t FrameWriter::add(FrameImage frame) {
  const size_t before = next_;
  const size_t index = frame.index;
  waiting_.emplace(index, std::move(frame));
  while (!waiting_.empty() && waiting_.begin()->first == next_) {
    write(waiting_.begin()->second);
    waiting_.erase(waiting_.begin());
    ++next_;
    save();
  }
  return next_ - before;
}

void FrameWriter::write(const FrameImage& frame) {
  const std::filesystem::path& file = setup_.plan.files[frame.index];
  const std::string extension = lower_extension(file);
  if (extension == ".exr") return write_exr(file, frame.exr);
  const Image image = image_of(frame.exr);
  if (extension == ".hdr") return write_image(file, image);
  Display display = display_for(setup_.settings.output, image.pixels, frame.in_studio);
  if (!setup_.settings.output.exposure) {
    if (exposure_) display.exposure = adapted_exposure(*exposure_, display.exposure, 1.0f / options_.fps);
    exposure_ = display.exposure;
  }
  const OcioView* const view = setup_.plan.ocio.get();
  const Image shown = view ? view->apply(image, display.exposure) : tone_map(image, display.tone_map, display.exposure);
  if (!cli::is_video_file(file)) return write_image(file, shown);
  if (!video_) video_.emplace(file, shown.width, shown.height, options_.fps);
  video_->add(shown);
}

void FrameWriter::save() const {
  if (options_.checkpoint.empty()) return;
  nlohmann::ordered_json json;
  json[kSequence] = identity_;
  json["next"] = next_;
  if (exposure_) json["exposure"] = *exposure_;
  write_file(options_.checkpoint, json.dump() + "\n");
}

void FrameWriter::finish() {
  if (video_) video_->finish();
}

}  // namespace relume::ranks

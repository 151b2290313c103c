// Read access to a session's images and buffers.
#include <algorithm>

#include <fmt/format.h>

#include "core/parallel.h"
#include "core/srgb.h"
#include "framebuffer/tone_map.h"
#include "relume/error.h"
#include "render/session_state.h"
#include "settings/nearest_name.h"

namespace relume {
namespace {

void write_pixel(const Rgb& radiance, std::byte* target, const ImageTarget& format, ToneMap curve, float exposure) {
  if (format.layout == PixelLayout::rgba8) {
    const Rgb shown = srgb_from_linear(tone_map(curve, exposure, radiance));
    for (int c = 0; c < 3; ++c) target[c] = static_cast<std::byte>(quantise_unorm8(shown[c]));
    target[3] = std::byte{255};
    return;
  }
  const Vec4 values(radiance, 1.0f);
  std::copy_n(reinterpret_cast<const std::byte*>(&values), pixel_bytes(format.layout), target);
}

/// The error for a name that is not in `list`; `what`: "is no buffer".
template <typename Info>
Error missing(std::string_view what, const std::string& name, const std::vector<Info>& list) {
  std::vector<std::string> names;
  for (const Info& info : list) names.push_back(info.name);
  return {ErrorCode::not_found,
          fmt::format("there {} '{}' with these settings{}", what, name, suggestion(name, names))};
}

void check_target(const ImageTarget& target, const BufferTable& buffers) {
  const auto width = static_cast<int>(buffers.width());
  const auto height = static_cast<int>(buffers.height());
  if (target.pixels == nullptr)
    throw Error("the image cannot be read, because ImageTarget::pixels is null; set it to the memory for the image");
  if (target.width != width || target.height != height) {
    throw Error(fmt::format("the image has {}x{} pixels, but the target has {}x{}; use a target of the image's size",
                            width, height, target.width, target.height));
  }
  const size_t row = static_cast<size_t>(width) * pixel_bytes(target.layout);
  if (target.row_stride != 0 && target.row_stride < row)
    throw Error(
        fmt::format("ImageTarget::row_stride is {} bytes, but a row needs {}; raise it, or use 0 for packed rows",
                    target.row_stride, row));
}

/// Whether a buffer can be inspected: others have records that only kernels read.
bool is_inspectable(const BufferDescription& buffer) { return buffer.id.type != BufferType::record; }

BufferInfo info_of(const Buffer& buffer, const BufferTable& table) {
  const BufferId& id = buffer.description().id;
  return {.name = std::string(id.name),
          .help = buffer.description().help,
          .type = id.type == BufferType::u32 ? ElementType::uint32 : ElementType::float32,
          .width = table.width(),
          .height = table.height(),
          .channels = static_cast<uint32_t>(id.element_bytes / sizeof(float)),
          .pixel_stride = id.element_bytes,
          .row_stride = size_t{id.element_bytes} * table.width()};
}

}  // namespace

Image Session::image() const {
  const BufferTable& buffers = *state_->buffers;
  Image image(static_cast<int>(buffers.width()), static_cast<int>(buffers.height()));
  const View<const Rgb> shown = state_->shown();
  std::copy(shown.begin(), shown.end(), image.pixels.begin());
  return image;
}

std::shared_ptr<const Image> Session::snapshot() const { return std::make_shared<const Image>(image()); }

void Session::read(const ImageTarget& target, ToneMap curve, float exposure) const {
  check_target(target, *state_->buffers);
  const View<const Rgb> shown = state_->shown();
  const size_t pixel = pixel_bytes(target.layout);
  const auto width = static_cast<size_t>(target.width);
  const size_t stride = target.row_stride > 0 ? target.row_stride : width * pixel;
  const auto read_row = [&](size_t y) {
    std::byte* row = static_cast<std::byte*>(target.pixels) + y * stride;
    for (size_t x = 0; x < width; ++x) {
      const Rgb radiance = shown.empty() ? Rgb(0) : shown[static_cast<uint32_t>(y * width + x)];
      write_pixel(radiance, row + x * pixel, target, curve, exposure);
    }
  };
  state_->backend->execute([&] { parallel_for(static_cast<size_t>(target.height), read_row); });
}

void Session::replace_image(const Image& image) {
  const BufferTable& buffers = *state_->buffers;
  const auto width = static_cast<int>(buffers.width());
  const auto height = static_cast<int>(buffers.height());
  if (image.width != width || image.height != height || image.pixels.size() != buffers.width() * buffers.height()) {
    throw Error(fmt::format("the image has {}x{} pixels, but the session has {}x{}; use an image of the session's size",
                            image.width, image.height, width, height));
  }
  (state_->in_frame ? state_->next_replacement : state_->replacement) = image.pixels;
}

std::vector<BufferInfo> Session::buffers() const {
  std::vector<BufferInfo> list;
  for (const auto& buffer : state_->buffers->all()) {
    if (is_inspectable(buffer->description())) list.push_back(info_of(*buffer, *state_->buffers));
  }
  return list;
}

BufferData Session::buffer(const std::string& name) const {
  const Buffer* buffer = std::as_const(*state_->buffers).find(name);
  if (!buffer || !is_inspectable(buffer->description())) throw missing("is no buffer", name, buffers());
  return {info_of(*buffer, *state_->buffers), buffer->bytes()};
}

std::span<std::byte> Session::edit_buffer(const std::string& name) {
  buffer(name);  // throws for unknown names
  return state_->buffers->find(name)->bytes();
}

std::vector<RecordTable> Session::record_tables() const {
  std::vector<RecordTable> tables;
  for (PassRecords& records : state_->passes.pipeline.records()) tables.push_back(std::move(records.table));
  return tables;
}

RecordData Session::records(const std::string& name) const {
  for (const PassRecords& records : state_->passes.pipeline.records()) {
    if (records.table.name == name) return {records.table, records.read()};
  }
  throw missing("are no records", name, record_tables());
}

std::vector<PassInfo> Session::passes() const {
  std::vector<PassInfo> passes;
  for (const PassDeclaration& pass : state_->passes.pipeline.declarations())
    passes.push_back({std::string(pass.name), std::string(kStageNames[static_cast<size_t>(pass.stage)])});
  return passes;
}

void Session::on_pass(std::function<void(const std::string&)> hook) { state_->pass_hook = std::move(hook); }

}  // namespace relume

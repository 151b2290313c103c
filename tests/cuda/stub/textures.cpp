// Entry points of the stub driver: textures of OpenGL, which tests make.
#include <algorithm>
#include <cstring>

#include "stub/control.h"
#include "stub/guarded.h"

namespace stub {

/// CUDA_MEMCPY2D.
struct RowCopy {
  struct End {
    size_t x_bytes;
    size_t y;
    int type;
    const void* host;
    unsigned long long device;
    Texture* array;
    size_t pitch;
  };
  End from;
  End to;
  size_t row_bytes;
  size_t rows;
};

namespace {

constexpr unsigned kTexture2d = 0x0de1;
constexpr unsigned kWriteDiscard = 2;
constexpr int kDeviceMemory = 2;
constexpr int kArray = 3;
constexpr int kAllDevices = 1;

const std::byte* pointer(unsigned long long address) {
  return reinterpret_cast<const std::byte*>(address);  // NOLINT(performance-no-int-to-ptr)
}

bool is_mapped(const State& state, const Texture* texture) {
  return std::any_of(state.shared.begin(), state.shared.end(), [&](const SharedTexture* shared) {
    const auto found = state.textures.find(shared->name);
    return shared->mapped && found != state.textures.end() && &found->second == texture;
  });
}

/// Whether the copy fills a mapped texture from a block.
bool is_valid(const State& state, const RowCopy& copy) {
  const RowCopy::End& from = copy.from;
  const RowCopy::End& to = copy.to;
  if (from.type != kDeviceMemory || to.type != kArray || from.x_bytes + from.y + to.x_bytes + to.y > 0) return false;
  if (copy.rows == 0 || from.pitch < copy.row_bytes || !is_mapped(state, to.array)) return false;
  return copy.row_bytes == to.array->row_bytes && copy.rows == to.array->rows &&
         state.managed.contains(pointer(from.device), (copy.rows - 1) * from.pitch + copy.row_bytes);
}

}  // namespace

extern "C" {

void relume_stub_make_texture(unsigned name, size_t row_bytes, size_t rows) {
  State& state = State::get();
  const std::lock_guard lock(state.mutex);
  state.textures.erase(name);
  if (rows > 0) state.textures[name] = {row_bytes, rows, std::vector<std::byte>(row_bytes * rows)};
}

const void* relume_stub_texture(unsigned name) {
  State& state = State::get();
  const std::lock_guard lock(state.mutex);
  // OpenGL draws after the work that was queued before the texture was unmapped.
  for (Stream* stream : state.streams) {
    while (state.execute_one(*stream)) {
    }
  }
  return state.textures.at(name).pixels.data();
}

int cuGLGetDevices_v2(unsigned* count, int* devices, unsigned most, int list) {
  return with_context("cuGLGetDevices_v2", [&](State& state) {
    if (state.textures.empty()) return kInvalidGraphicsContext;
    if (list != kAllDevices || most == 0) return kInvalidValue;
    *count = 1;
    devices[0] = 0;  // the first GPU draws
    return kSuccess;
  });
}

int cuGraphicsGLRegisterImage(SharedTexture** texture, unsigned name, unsigned target, unsigned flags) {
  return with_context("cuGraphicsGLRegisterImage", [&](State& state) {
    if (!state.textures.contains(name)) return kInvalidGraphicsContext;
    if (target != kTexture2d || flags != kWriteDiscard) return kInvalidValue;
    create(state.shared, texture);
    (*texture)->name = name;
    return kSuccess;
  });
}

int cuGraphicsUnregisterResource(SharedTexture* texture) {
  return with_context("cuGraphicsUnregisterResource", [&](State& state) { return destroy(state.shared, texture); });
}

int cuGraphicsMapResources(unsigned count, SharedTexture** textures, Stream* stream) {
  return with_idle_stream("cuGraphicsMapResources", stream, [&](State& state) {
    if (count != 1 || !state.shared.contains(*textures)) return kInvalidHandle;
    if ((*textures)->mapped) return kAlreadyMapped;
    (*textures)->mapped = true;
    return kSuccess;
  });
}

int cuGraphicsUnmapResources(unsigned count, SharedTexture** textures, Stream* stream) {
  return with_idle_stream("cuGraphicsUnmapResources", stream, [&](State& state) {
    if (count != 1 || !state.shared.contains(*textures)) return kInvalidHandle;
    if (!(*textures)->mapped) return kNotMapped;
    (*textures)->mapped = false;
    return kSuccess;
  });
}

int cuGraphicsSubResourceGetMappedArray(Texture** array, SharedTexture* texture, unsigned index, unsigned level) {
  return with_context("cuGraphicsSubResourceGetMappedArray", [&](State& state) {
    if (!state.shared.contains(texture)) return kInvalidHandle;
    if (!texture->mapped) return kNotMapped;
    if (index != 0 || level != 0) return kInvalidValue;
    *array = &state.textures.at(texture->name);
    return kSuccess;
  });
}

int cuMemcpy2DAsync_v2(const RowCopy* copy, Stream* stream) {
  return with_idle_stream("cuMemcpy2DAsync_v2", stream, [&](State& state) {
    if (!is_valid(state, *copy)) return kInvalidValue;
    state.add_copy(*stream, [copy = *copy] {
      for (size_t y = 0; y < copy.rows; ++y) {
        std::memcpy(copy.to.array->pixels.data() + y * copy.row_bytes, pointer(copy.from.device) + y * copy.from.pitch,
                    copy.row_bytes);
      }
    });
    return kSuccess;
  });
}

}  // extern "C"
}  // namespace stub

// Entry points of the stub driver share this.
#pragma once

#include <mutex>
#include <thread>

#include "stub/state.h"

namespace stub {

/// An entry point that needs no context: calls body(state), unless a failure is injected.
template <typename F>
int without_context(const char* function, const F& body) {
  State& state = State::get();
  const std::lock_guard lock(state.mutex);
  if (const auto failure = state.enter(function)) return *failure;
  return body(state);
}

/// The same for one that needs a current context.
template <typename F>
int with_context(const char* function, const F& body) {
  State& state = State::get();
  const std::lock_guard lock(state.mutex);
  if (const auto failure = state.enter_context(function)) return *failure;
  return body(state);
}

/// The same for one that needs memory or compiles, which a capture on the calling thread does not permit.
template <typename F>
int outside_of_captures(const char* function, const F& body) {
  return with_context(function, [&](State& state) {
    for (Stream* stream : state.streams) {
      if (!stream->capture || stream->capture->thread != std::this_thread::get_id()) continue;
      stream->capture->valid = false;
      return kCaptureUnsupported;
    }
    return body(state);
  });
}

/// The same for one that uses a stream, and that a capture on the stream does not permit.
template <typename F>
int with_idle_stream(const char* function, Stream* stream, const F& body) {
  return with_context(function, [&](State& state) {
    if (!state.streams.contains(stream)) return kInvalidHandle;
    if (!stream->capture) return body(state);
    stream->capture->valid = false;
    return kCaptureUnsupported;
  });
}

/// Makes an object that a handle points to.
template <typename T>
int create(std::set<T*>& all, T** handle) {
  *handle = *all.insert(new T).first;
  return kSuccess;
}

template <typename T>
int destroy(std::set<T*>& all, T* handle) {
  if (all.erase(handle) == 0) return kInvalidHandle;
  delete handle;
  return kSuccess;
}

}  // namespace stub

// Entry points of the stub driver share this.
#pragma once

#include <mutex>

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

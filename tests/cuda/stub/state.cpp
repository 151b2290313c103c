#include "stub/state.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <utility>

#include "runtime/launch.h"

namespace stub {

State::State() {
  const char* const text = std::getenv("RELUME_STUB_DRIVER");
  settings = parse_settings(text ? text : "");
  if (!settings.log_file.empty()) std::atexit([] { get().write_log(); });
}

State& State::get() {
  static State* const state = new State;  // never destroyed: programs may free objects at exit
  return *state;
}

void State::configure(const std::string& text) {
  settings = parse_settings(text);
  sticky = kSuccess;
  leaked = 0;
  moved_to.clear();
  calls_.clear();
  launches_ = 0;
  launched_.clear();
}

void State::end_contexts() {
  if (sticky == kSuccess) {
    leaked += modules.size() + streams.size() + events.size() + graphs.size() + executions.size() + shared.size() +
              managed.count() + locked.size();
  }
  for (const Module* module : modules) delete module;
  for (const Stream* stream : streams) delete stream;
  for (const Event* event : events) delete event;
  for (const Graph* graph : graphs) delete graph;
  for (const GraphExecution* execution : executions) delete execution;
  for (const SharedTexture* texture : shared) delete texture;
  for (const auto& block : locked) std::free(block.first);
  modules.clear();
  streams.clear();
  events.clear();
  graphs.clear();
  executions.clear();
  shared.clear();
  locked.clear();
  managed.clear();
  memory_work_ = 0;
}

std::optional<int> State::enter(const std::string& function) {
  const size_t number = ++calls_[function];
  const auto failure = settings.failures.find({function, number});
  if (failure != settings.failures.end()) {
    const bool is_launch_error = failure->second >= 700 && failure->second <= kLaunchFailed && failure->second != 701;
    if (is_launch_error || failure->second == kContained) sticky = failure->second;
    return failure->second;
  }
  return std::nullopt;
}

std::optional<int> State::enter_context(const std::string& function) {
  if (const auto failure = enter(function)) return failure;
  if (!initialized) return kNotInitialized;
  if (current_contexts().empty()) return kInvalidContext;
  if (sticky != kSuccess) return sticky;
  return std::nullopt;
}

size_t State::calls(const std::string& function) const {
  const auto found = calls_.find(function);
  return found == calls_.end() ? 0 : found->second;
}

void State::write_log() {
  const std::lock_guard lock(mutex);
  std::ofstream file(settings.log_file);
  for (const ptx::Entry* entry : launched_) file << entry->name << "\n";
}

void State::add(Stream& stream, std::function<void()> work) {
  stream.work.push_back(std::move(work));
  if (settings.eager) {
    while (execute_one(stream)) {
    }
  }
}

void State::add_work(Stream& stream, std::function<void()> work) {
  if (!settings.open) managed.close();
  ++memory_work_;
  add(stream, [this, work = std::move(work)] {
    --memory_work_;
    if (sticky != kSuccess) return;
    managed.open();
    work();
    if (!settings.open) managed.close();
  });
}

void State::add_copy(Stream& stream, std::function<void()> work) {
  add(stream, [this, work = std::move(work)] {
    if (sticky != kSuccess) return;
    const bool was_open = managed.is_open();
    managed.open();
    work();
    if (!was_open) managed.close();
  });
}

void State::wait_for(const Stream& waiting, const Event* event, size_t record) {
  const auto progresses = [&] {
    return std::any_of(streams.begin(), streams.end(),
                       [&](Stream* stream) { return stream != &waiting && execute_one(*stream); });
  };
  while (sticky == kSuccess && event->reached < record && progresses()) {
  }
}

void State::add_kernel(Stream& stream, KernelCall call) {
  launched_.push_back(call.function->entry);
  add_work(stream, [this, call = std::move(call)] { run(call); });
}

int State::add_node(Stream& stream, GraphNode node) {
  if (!stream.capture) {
    node.add(stream);
    return kSuccess;
  }
  if (!stream.capture->valid) return kCaptureInvalidated;
  stream.capture->graph.nodes.push_back(std::move(node));
  return kSuccess;
}

void State::record(Stream& stream, Event* event) {
  event->done = false;
  add(stream, [this, event, record = ++event->records] {
    if (sticky != kSuccess || !events.contains(event)) return;
    event->reached = record;
    if (record != event->records) return;
    event->done = true;
    event->time_s = clock_s;
  });
}

bool State::execute_one(Stream& stream) {
  if (stream.work.empty()) return false;
  const std::function<void()> work = std::move(stream.work.front());
  stream.work.pop_front();
  work();
  return true;
}

void State::open_memory() {
  if (memory_work_ == 0) managed.open();
}

void State::drain(Stream& stream) {
  while (execute_one(stream)) {
  }
  open_memory();
}

void State::drain_all() {
  for (Stream* stream : streams) drain(*stream);
}

void State::run(const KernelCall& call) {
  if (++launches_ == settings.lose) {
    sticky = kLaunchFailed;
    return;
  }
  ptx::Launch launch;
  launch.grid = {call.grid[0], call.grid[1], call.grid[2]};
  launch.block = {call.block[0], call.block[1], call.block[2]};
  launch.dynamic_shared_bytes = call.shared_bytes;
  launch.seed = settings.seed + launches_;
  clock_s += settings.thread_s * call.grid[0] * call.grid[1] * call.block[0] * call.block[1];
  std::vector<void*> parameters;
  for (const std::vector<uint64_t>& value : call.parameters) parameters.push_back(const_cast<uint64_t*>(value.data()));
  parameters.push_back(nullptr);
  const Module& module = *call.function->module;
  for (const auto& [symbol, value] : module.variables) std::memcpy(symbol->address, value.data(), value.size());
  try {
    ptx::run_grid(*module.translated, *call.function->entry, launch, parameters.data());
  } catch (const ptx::Fault&) {
    sticky = kLaunchFailed;
  }
}

std::vector<Context*>& current_contexts() {
  thread_local std::vector<Context*> contexts;
  return contexts;
}

}  // namespace stub

#include "frame/cuda/launch_graphs.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace relume::cuda {
namespace {

std::vector<LaunchGraph::Step> steps_of(std::span<const KernelCall> calls) {
  std::vector<LaunchGraph::Step> steps;
  const KernelCall* before = nullptr;
  for (const KernelCall& call : calls) {
    const bool copies = !call.argument.empty() && (!before || before->argument != call.argument);
    steps.push_back({call.kernel->function, call.argument.size(), call.group_threads, copies});
    before = &call;
  }
  return steps;
}

bool has_windows(const LaunchGraph& graph, std::span<const KernelCall> calls) {
  return std::equal(graph.windows.begin(), graph.windows.end(), calls.begin(), calls.end(),
                    [](const Tile& window, const KernelCall& call) { return window == call.window; });
}

/// A captured graph, for its lifetime.
class CapturedGraph {
 public:
  explicit CapturedGraph(const Driver& driver) : driver_(driver) {}
  ~CapturedGraph() {
    if (graph) driver_.cuGraphDestroy(graph);
  }
  CapturedGraph(const CapturedGraph&) = delete;
  CapturedGraph& operator=(const CapturedGraph&) = delete;

  Graph graph = nullptr;

 private:
  const Driver& driver_;
};

std::byte* argument_of(const LaunchGraph& graph, size_t index) {
  return static_cast<std::byte*>(graph.arguments) + index * kArgumentBytes;
}

}  // namespace

LaunchGraphs::LaunchGraphs(Queue& queue, LaunchSlots& slots, DeviceAddress argument, bool enabled)
    : queue_(queue), slots_(slots), argument_(argument), enabled_(enabled && queue.driver().has_graphs()) {}

LaunchGraphs::~LaunchGraphs() {
  queue_.free_objects([&] {
    queue_.driver().cuStreamSynchronize(queue_.stream());
    for (const auto& graph : graphs_) free(*graph);
    if (stream_) queue_.driver().cuStreamDestroy(stream_);
  });
}

void LaunchGraphs::free(LaunchGraph& graph) const {
  const Driver& driver = queue_.driver();
  if (graph.execution) driver.cuGraphExecDestroy(graph.execution);
  for (const Event event : graph.ends) driver.cuEventDestroy(event);
  if (graph.arguments) driver.cuMemFreeHost(graph.arguments);
}

bool LaunchGraphs::accepts(Result result) {
  const bool accepted = queue_.accepts(result, "using a graph of launches");
  if (!accepted) enabled_ = false;
  return accepted;
}

LaunchGraph* LaunchGraphs::find(std::span<const LaunchGraph::Step> steps) {
  const auto found = std::find_if(graphs_.begin(), graphs_.end(), [&](const auto& graph) {
    return std::equal(graph->steps.begin(), graph->steps.end(), steps.begin(), steps.end());
  });
  return found == graphs_.end() ? nullptr : found->get();
}

void LaunchGraphs::remember(std::vector<LaunchGraph::Step> steps) {
  if (graphs_.size() == kMostSequences) {
    const auto oldest = std::min_element(graphs_.begin(), graphs_.end(),
                                         [](const auto& a, const auto& b) { return a->last_use < b->last_use; });
    slots_.wait_for((*oldest)->used_until);
    free(**oldest);
    graphs_.erase(oldest);
  }
  graphs_.push_back(std::make_unique<LaunchGraph>());
  graphs_.back()->steps = std::move(steps);
  graphs_.back()->last_use = ++uses_;
}

LaunchGraph* LaunchGraphs::prepare(std::span<const KernelCall> calls) {
  // One launch takes as many calls of the driver with a graph as without.
  if (!enabled_ || calls.size() < 2) return nullptr;
  std::vector<LaunchGraph::Step> steps = steps_of(calls);
  LaunchGraph* const graph = find(steps);
  if (!graph) {
    remember(std::move(steps));
    return nullptr;
  }
  graph->last_use = ++uses_;
  // Its last launch reads the arguments, and its events have the times.
  slots_.wait_for(graph->used_until);
  if (!make_objects(*graph)) return nullptr;
  write_arguments(*graph, calls);
  if (graph->execution && has_windows(*graph, calls)) return graph;
  return record(*graph, calls) ? graph : nullptr;
}

bool LaunchGraphs::make_objects(LaunchGraph& graph) {
  const Driver& driver = queue_.driver();
  const size_t launches = graph.steps.size();
  if (!stream_ && !accepts(driver.cuStreamCreate(&stream_, kStreamNonBlocking))) return false;
  if (!graph.arguments && !accepts(driver.cuMemHostAlloc(&graph.arguments, launches * kArgumentBytes, 0))) return false;
  while (graph.ends.size() + 1 < launches) {
    Event event = nullptr;
    if (!accepts(driver.cuEventCreate(&event, kEventBlockingSync))) return false;
    graph.ends.push_back(event);
  }
  return true;
}

void LaunchGraphs::write_arguments(const LaunchGraph& graph, std::span<const KernelCall> calls) const {
  for (size_t i = 0; i < calls.size(); ++i) {
    const std::vector<std::byte>& argument = calls[i].argument;
    if (graph.steps[i].copies_argument) std::memcpy(argument_of(graph, i), argument.data(), argument.size());
  }
}

Result LaunchGraphs::capture_launch(const LaunchGraph& graph, const KernelCall& call, size_t index) {
  const Driver& driver = queue_.driver();
  Result result = Result::success;
  if (graph.steps[index].copies_argument)
    result = driver.cuMemcpyHtoDAsync(argument_, argument_of(graph, index), call.argument.size(), stream_);
  if (result == Result::success) result = queue_kernel(driver, stream_, call);
  if (result == Result::success && index < graph.ends.size())
    result = driver.cuEventRecordWithFlags(graph.ends[index], stream_, kEventRecordExternal);
  return result;
}

bool LaunchGraphs::record(LaunchGraph& graph, std::span<const KernelCall> calls) {
  const Driver& driver = queue_.driver();
  CapturedGraph captured(driver);
  if (!accepts(driver.cuStreamBeginCapture(stream_, kCaptureThreadLocal))) return false;
  Result result = Result::success;
  for (size_t i = 0; i < calls.size() && result == Result::success; ++i) result = capture_launch(graph, calls[i], i);
  const Result ended = driver.cuStreamEndCapture(stream_, &captured.graph);  // also after an error
  if (!accepts(result) || !accepts(ended)) return false;
  if (graph.execution) {
    GraphNode failed = nullptr;
    int reason = 0;
    const Result updated = driver.cuGraphExecUpdate(graph.execution, captured.graph, &failed, &reason);
    if (!queue_.accepts(updated, "updating a graph of launches"))
      driver.cuGraphExecDestroy(std::exchange(graph.execution, nullptr));
  }
  if (!graph.execution) {
    GraphExecution made = nullptr;
    if (!accepts(driver.cuGraphInstantiate(&made, captured.graph, nullptr, nullptr, 0))) return false;
    graph.execution = made;
  }
  graph.windows.clear();
  for (const KernelCall& call : calls) graph.windows.push_back(call.window);
  return true;
}

}  // namespace relume::cuda

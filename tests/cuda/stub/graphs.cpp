// Entry points of the stub driver: captures and graphs.
#include <algorithm>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "stub/guarded.h"

namespace stub {
namespace {

constexpr int kThreadLocal = 1;
constexpr unsigned kExternal = 1;

/// Ends the capture of a stream.
std::optional<Capture> take_capture(Stream* stream) {
  State& state = State::get();
  const std::lock_guard lock(state.mutex);
  return state.streams.contains(stream) ? std::exchange(stream->capture, std::nullopt) : std::nullopt;
}

}  // namespace

extern "C" {

int cuStreamBeginCapture_v2(Stream* stream, int mode) {
  return with_idle_stream("cuStreamBeginCapture_v2", stream, [&](State&) {
    // Others forbid calls to all threads, or permit calls that break the capture.
    if (mode != kThreadLocal) return kInvalidValue;
    stream->capture = Capture{.thread = std::this_thread::get_id(), .graph = {}};
    return kSuccess;
  });
}

int cuStreamEndCapture(Stream* stream, Graph** graph) {
  *graph = nullptr;
  const std::optional<Capture> ended = take_capture(stream);  // an error ends it, too
  return with_context("cuStreamEndCapture", [&](State& state) {
    if (!state.streams.contains(stream)) return kInvalidHandle;
    if (!ended) return kInvalidValue;
    if (ended->thread != std::this_thread::get_id()) return kCaptureUnmatched;
    if (!ended->valid) return kCaptureInvalidated;
    create(state.graphs, graph);
    **graph = ended->graph;
    return kSuccess;
  });
}

int cuEventRecordWithFlags(Event* event, Stream* stream, unsigned flags) {
  return with_context("cuEventRecordWithFlags", [&](State& state) {
    if (!state.events.contains(event) || !state.streams.contains(stream)) return kInvalidHandle;
    if (flags != kExternal || !stream->capture) return kInvalidValue;
    return state.add_node(*stream,
                          {GraphNode::Kind::event, [&state, event](Stream& into) { state.record(into, event); }});
  });
}

int cuGraphInstantiate_v2(GraphExecution** execution, Graph* graph, void**, char*, size_t) {
  return outside_of_captures("cuGraphInstantiate_v2", [&](State& state) {
    if (!state.graphs.contains(graph)) return kInvalidHandle;
    create(state.executions, execution);
    (*execution)->nodes = graph->nodes;
    return kSuccess;
  });
}

int cuGraphExecUpdate(GraphExecution* execution, Graph* graph, void** failed, int* reason) {
  return outside_of_captures("cuGraphExecUpdate", [&](State& state) {
    if (!state.executions.contains(execution) || !state.graphs.contains(graph)) return kInvalidHandle;
    const bool fits = std::equal(execution->nodes.begin(), execution->nodes.end(), graph->nodes.begin(),
                                 graph->nodes.end(), [](const auto& a, const auto& b) { return a.kind == b.kind; });
    *failed = nullptr;
    *reason = fits ? 0 : 1;
    if (!fits) return kGraphUpdateFailure;
    execution->nodes = graph->nodes;
    return kSuccess;
  });
}

int cuGraphLaunch(GraphExecution* execution, Stream* stream) {
  return with_idle_stream("cuGraphLaunch", stream, [&](State& state) {
    if (!state.executions.contains(execution)) return kInvalidHandle;
    for (const GraphNode& node : execution->nodes) node.add(*stream);
    return kSuccess;
  });
}

int cuGraphExecDestroy(GraphExecution* execution) {
  return with_context("cuGraphExecDestroy", [&](State& state) { return destroy(state.executions, execution); });
}

int cuGraphDestroy(Graph* graph) {
  return with_context("cuGraphDestroy", [&](State& state) { return destroy(state.graphs, graph); });
}

}  // extern "C"
}  // namespace stub

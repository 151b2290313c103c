// Sequences of launches as CUDA graphs, which the driver takes in one call.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "frame/cuda/kernel_call.h"
#include "frame/cuda/launch_slots.h"
#include "frame/cuda/queue.h"

namespace relume::cuda {

/// A sequence of launches, and its graph once it has come twice. A launch is a copy of its argument into the device's
/// constant, unless the launch before has the same one, the kernel, and an event that ends it.
struct LaunchGraph {
  /// Properties of a launch that an update of the graph cannot change.
  struct Step {
    Function function = nullptr;
    size_t argument_bytes = 0;
    uint32_t group_threads = 0;
    bool copies_argument = true;
    bool operator==(const Step&) const = default;
  };
  std::vector<Step> steps;
  std::vector<Tile> windows;           ///< of the launches in the graph
  GraphExecution execution = nullptr;  ///< nullptr: no graph yet
  void* arguments = nullptr;           ///< page-locked, kArgumentBytes for each launch: the device copies them
  std::vector<Event> ends;             ///< of all launches but the last
  size_t used_until = 0;               ///< LaunchSlots::launched() after the last launch of the graph
  uint64_t last_use = 0;
};

/// The graphs of a device. A sequence is launched without a graph when it comes for the first time, which also loads
/// kernels: a capture might not permit that. The second time it is captured. From then on, its arguments are written to
/// the memory that the graph reads. If a window has changed, the sequence is captured again and updates the graph; if
/// the driver refuses the update, it makes another graph. If the driver refuses a capture or a graph, no more graphs
/// are used. One thread at a time uses this, with the queue's context current.
class LaunchGraphs {
 public:
  /// Most launches of a graph.
  static constexpr size_t kMostLaunches = 32;
  /// Most sequences that are kept. The least recently used one makes room.
  static constexpr size_t kMostSequences = 64;

  /// `argument`: the device's constant. `enabled`: whether graphs are used at all.
  LaunchGraphs(Queue& queue, LaunchSlots& slots, DeviceAddress argument, bool enabled);
  ~LaunchGraphs();
  LaunchGraphs(const LaunchGraphs&) = delete;
  LaunchGraphs& operator=(const LaunchGraphs&) = delete;

  /// The graph for launches, with their arguments and windows, valid until the next call; nullptr if they are to be
  /// launched without. Each of them must be one grid. Throws as Queue::check() if the device is lost.
  LaunchGraph* prepare(std::span<const KernelCall> calls);
  /// Call it after the graph is launched and its launches have slots.
  void launched(LaunchGraph& graph) const { graph.used_until = slots_.launched(); }
  /// Returns whether the driver has accepted a step of using graphs; if not, no more are used. Throws as prepare().
  bool accepts(Result result);

 private:
  LaunchGraph* find(std::span<const LaunchGraph::Step> steps);
  void remember(std::vector<LaunchGraph::Step> steps);
  /// Makes the objects that the graph of a sequence refers to. Returns false if the driver refuses.
  bool make_objects(LaunchGraph& graph);
  void write_arguments(const LaunchGraph& graph, std::span<const KernelCall> calls) const;
  /// Captures the launches, and updates or makes the graph. Returns false if the driver refuses.
  bool record(LaunchGraph& graph, std::span<const KernelCall> calls);
  Result capture_launch(const LaunchGraph& graph, const KernelCall& call, size_t index);
  /// Frees the graph's objects, which no queued work uses.
  void free(LaunchGraph& graph) const;

  Queue& queue_;
  LaunchSlots& slots_;
  DeviceAddress argument_;
  bool enabled_;
  Stream stream_ = nullptr;  ///< only for captures: work of other threads may be added to the queue's stream meanwhile
  std::vector<std::unique_ptr<LaunchGraph>> graphs_;
  uint64_t uses_ = 0;
};

}  // namespace relume::cuda

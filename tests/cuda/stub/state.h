// State of the stub driver. Its queue executes kernels with the executor of tests/ptx.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "runtime/module.h"
#include "stub/memory.h"
#include "stub/settings.h"

namespace stub {

// Results of the driver's functions that the stub returns itself.
inline constexpr int kSuccess = 0;
inline constexpr int kInvalidValue = 1;
inline constexpr int kOutOfMemory = 2;
inline constexpr int kNotInitialized = 3;
inline constexpr int kNoDevice = 100;
inline constexpr int kInvalidDevice = 101;
inline constexpr int kInvalidContext = 201;
inline constexpr int kAlreadyMapped = 208;
inline constexpr int kNotMapped = 211;
inline constexpr int kInvalidPtx = 218;
inline constexpr int kInvalidGraphicsContext = 219;
inline constexpr int kContained = 226;
inline constexpr int kInvalidHandle = 400;
inline constexpr int kNotFound = 500;
inline constexpr int kNotReady = 600;
inline constexpr int kIllegalAddress = 700;
inline constexpr int kLaunchFailed = 719;
inline constexpr int kCaptureUnsupported = 900;
inline constexpr int kCaptureInvalidated = 901;
inline constexpr int kCaptureUnmatched = 903;
inline constexpr int kGraphUpdateFailure = 910;

// Objects behind the handles.
struct Context {
  int device = 0;
  size_t retained = 0;
};
struct Module;
struct Function {
  Module* module = nullptr;
  const ptx::Entry* entry = nullptr;
};
/// A module that is loaded. The translation exists once, so that each loaded module keeps the variables that the host
/// writes, and those of the translation take their values for a launch.
struct Module {
  const ptx::Module* translated = nullptr;
  std::map<const ptx::Entry*, Function> functions;                     ///< those that the host has asked for
  std::map<const ptx::Symbol*, std::vector<unsigned char>> variables;  ///< the same
};
struct Event {
  size_t records = 0;  ///< the last one counts
  size_t reached = 0;  ///< the last one that was reached
  bool done = false;   ///< whether that was reached
  double time_s = 0;
};
struct Stream;
/// A node of a graph: work that each launch of the graph adds to a stream, after the nodes before it.
struct GraphNode {
  enum class Kind { kernel, copy, event };
  Kind kind = Kind::kernel;
  std::function<void(Stream&)> add;
};
struct Graph {
  std::vector<GraphNode> nodes;
};
/// A graph that can be launched, with copies of the nodes.
struct GraphExecution {
  std::vector<GraphNode> nodes;
};
/// A capture: the stream's calls become nodes.
struct Capture {
  std::thread::id thread;
  Graph graph;
  bool valid = true;  ///< not after a call that it does not permit
};
/// Work of a queue, in order. Without "eager", it runs when the host waits for it or asks about it, which shows whether
/// the host waits where it must.
struct Stream {
  std::deque<std::function<void()>> work;
  std::optional<Capture> capture;
};

/// A texture of OpenGL.
struct Texture {
  size_t row_bytes = 0;
  size_t rows = 0;
  std::vector<std::byte> pixels;
};
/// A texture that the driver has registered.
struct SharedTexture {
  unsigned name = 0;
  bool mapped = false;
};

/// A kernel that is launched.
struct KernelCall {
  const Function* function = nullptr;
  uint32_t grid[3] = {1, 1, 1};
  uint32_t block[3] = {1, 1, 1};
  size_t shared_bytes = 0;
  std::vector<std::vector<uint64_t>> parameters;  ///< copies of the values
};

class State {
 public:
  static State& get();

  void configure(const std::string& text);

  /// Counts a call. Returns the result that it must return at once, if there is one: an injected failure, or the error
  /// that the device did not survive.
  std::optional<int> enter(const std::string& function);
  /// The same for functions that need a current context.
  std::optional<int> enter_context(const std::string& function);
  size_t calls(const std::string& function) const;
  /// Writes the names of the launched kernels to the file of the settings, one per line.
  void write_log();

  void add(Stream& stream, std::function<void()> work);
  /// The same for work that accesses managed memory. The host cannot access any until no such work is queued and the
  /// host has waited.
  void add_work(Stream& stream, std::function<void()> work);
  /// The same for work that accesses blocks which the host does not access meanwhile: others stay open.
  void add_copy(Stream& stream, std::function<void()> work);
  /// Executes work of other streams until a record of the event is reached.
  void wait_for(const Stream& waiting, const Event* event, size_t record);
  void add_kernel(Stream& stream, KernelCall call);
  /// Adds a node to the stream's capture, or its work to the stream if there is no capture.
  int add_node(Stream& stream, GraphNode node);
  void record(Stream& stream, Event* event);
  /// Executes the first piece of work. Returns false if there is none.
  bool execute_one(Stream& stream);
  /// The host has waited: it may access managed memory if no work on it is queued.
  void open_memory();
  /// Executes all work.
  void drain(Stream& stream);
  /// The same of all streams, as calls that free memory do.
  void drain_all();

  /// Frees the objects of all contexts, the last of which has ended. The error that the device did not survive stays.
  void end_contexts();

  Settings settings;
  bool initialized = false;
  int sticky = kSuccess;  ///< the error that the device did not survive
  std::map<int, Context> contexts;
  std::set<Module*> modules;
  std::set<Stream*> streams;
  std::set<Event*> events;
  std::set<Graph*> graphs;
  std::set<GraphExecution*> executions;
  std::map<unsigned, Texture> textures;  ///< by name
  std::set<SharedTexture*> shared;
  ManagedBlocks managed;
  std::map<void*, size_t> locked;  ///< page-locked blocks
  size_t leaked = 0;               ///< objects that end_contexts() freed after no error
  double clock_s = 0;              ///< of the device: Settings::thread_s, and 0.1 ns for each byte that is moved
  std::map<int, size_t> moved_to;  ///< number of blocks that were moved to each device
  std::mutex mutex;                ///< held by every entry point

 private:
  State();
  void run(const KernelCall& call);

  std::map<std::string, size_t> calls_;
  std::vector<const ptx::Entry*> launched_;
  size_t launches_ = 0;
  size_t memory_work_ = 0;  ///< queued pieces of work on managed memory
};

/// The contexts that are current on this thread; the last one is used.
std::vector<Context*>& current_contexts();

}  // namespace stub

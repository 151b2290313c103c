// The functions of the plugin relume-mpi, which alone is linked with an MPI library. In C types, because program and
// plugin may be built by different compilers.
#pragma once

#include <cstdint>

extern "C" {

/// All functions are called by one thread, and none waits for other ranks except begin() and end(). They return
/// whether they succeeded.
struct RelumeMpi {
  int version;          ///< kRelumeMpiVersion
  const char* library;  ///< "Open MPI 4.1.4"
  /// Starts MPI.
  bool (*begin)(int* rank, int* size);
  /// Starts to send `size` bytes, which must exist until complete() reports it. `request`: nullptr if it failed.
  bool (*send)(int to, int tag, const void* bytes, int size, void** request);
  /// Whether a send or a receive is complete; its request then no longer exists.
  bool (*complete)(void* request, bool* done);
  /// Looks for a message of this rank and tag. `message`: nullptr if there is none.
  bool (*find)(int from, int tag, int* size, void** message);
  /// Starts to receive a message of find(). `request`: nullptr if it failed.
  bool (*receive)(void* message, void* bytes, int size, void** request);
  /// Ends MPI, once all ranks call it.
  bool (*end)();
  /// Ends all ranks, as far as the launcher reaches them.
  void (*abort)(int code);
};

inline constexpr int kRelumeMpiVersion = 1;
/// Name of the plugin's function that returns its RelumeMpi.
inline constexpr const char* kRelumeMpiFunction = "relume_mpi";
using RelumeMpiFunction = const RelumeMpi* (*)();
}

#include "ranks/mpi_plugin.h"

#include <mpi.h>

#include <new>

namespace {

/// Passes on a request that MPI has started; nullptr otherwise, because complete() must not see an undefined one.
bool pass_on(MPI_Request* started, bool works, void** request) {
  *request = works ? started : nullptr;
  if (!works) delete started;
  return works;
}

bool begin(int* rank, int* size) {
  int provided = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS) return false;
  // The default handler would end the process at the first lost connection, without a checkpoint.
  return MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN) == MPI_SUCCESS &&
         MPI_Comm_rank(MPI_COMM_WORLD, rank) == MPI_SUCCESS && MPI_Comm_size(MPI_COMM_WORLD, size) == MPI_SUCCESS;
}

bool send(int to, int tag, const void* bytes, int size, void** request) {
  auto* const started = new (std::nothrow) MPI_Request;
  const bool works = started && MPI_Isend(bytes, size, MPI_BYTE, to, tag, MPI_COMM_WORLD, started) == MPI_SUCCESS;
  return pass_on(started, works, request);
}

bool complete(void* request, bool* done) {
  auto* const started = static_cast<MPI_Request*>(request);
  int flag = 0;
  const bool works = MPI_Test(started, &flag, MPI_STATUS_IGNORE) == MPI_SUCCESS;
  *done = flag != 0;
  if (*done) delete started;
  return works;
}

bool find(int from, int tag, int* size, void** message) {
  *message = nullptr;
  auto* const found = new (std::nothrow) MPI_Message;
  if (!found) return false;
  int flag = 0;
  MPI_Status status;
  const bool works = MPI_Improbe(from, tag, MPI_COMM_WORLD, &flag, found, &status) == MPI_SUCCESS &&
                     (flag == 0 || MPI_Get_count(&status, MPI_BYTE, size) == MPI_SUCCESS);
  if (works && flag != 0) {
    *message = found;
  } else {
    delete found;
  }
  return works;
}

bool receive(void* message, void* bytes, int size, void** request) {
  auto* const found = static_cast<MPI_Message*>(message);
  auto* const started = new (std::nothrow) MPI_Request;
  const bool works = started && MPI_Imrecv(bytes, size, MPI_BYTE, found, started) == MPI_SUCCESS;
  delete found;
  return pass_on(started, works, request);
}

bool end() { return MPI_Finalize() == MPI_SUCCESS; }

void abort_all(int code) { MPI_Abort(MPI_COMM_WORLD, code); }

const char* library() {
  static char name[MPI_MAX_LIBRARY_VERSION_STRING];
  int length = 0;
  return MPI_Get_library_version(name, &length) == MPI_SUCCESS ? name : "MPI";
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const RelumeMpi* relume_mpi() {
  static const RelumeMpi functions{kRelumeMpiVersion, library(), begin, send, complete, find, receive, end, abort_all};
  return &functions;
}

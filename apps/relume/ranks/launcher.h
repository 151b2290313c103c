// The launcher that started this process as one of several ranks: mpirun of Open MPI or MPICH, or srun.
#pragma once

#include <optional>
#include <string>

#include "ranks/mpi_plugin.h"

namespace relume::ranks {

enum class MpiLibrary { open_mpi, mpich };

/// What the launcher's environment variables say.
struct Launch {
  MpiLibrary library = MpiLibrary::open_mpi;
  int rank = 0;
  int size = 1;
  int local_size = 1;  ///< ranks on this machine
};

/// std::nullopt: no launcher started the process, or RELUME_MPI_PLUGIN is empty, which means to ignore it.
std::optional<Launch> find_launch();

/// Loads the plugin for the launcher's library from beside the program, ../lib/relume or RELUME_MPI_PLUGIN. Throws
/// Error that says what to install.
const RelumeMpi& load_mpi(MpiLibrary library);

/// Threads for a rank that shares its machine with others: the processors that it is bound to, or else its share.
int threads_of_rank(const Launch& launch);

/// Ends the launcher if it still waits `after_s` seconds after this process: it may wait for a host that cannot be
/// reached. Call it last.
void end_launcher(int after_s);

/// Name of this machine.
std::string host_name();

}  // namespace relume::ranks

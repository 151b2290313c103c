#include "ranks/launcher.h"

#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace relume::ranks {
namespace {

/// Sets exactly these of the launchers' variables, and restores the test's own.
class Variables {
 public:
  explicit Variables(const std::map<std::string, std::string>& values) {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_LOCAL_SIZE", "PMI_SIZE",
                             "PMI_RANK", "MPI_LOCALNRANKS", "PMIX_RANK", "SLURM_STEP_NUM_TASKS", "SLURM_PROCID",
                             "SLURM_NTASKS", "RELUME_MPI_PLUGIN"}) {
      if (const char* const own = std::getenv(name)) own_[name] = own;
      unsetenv(name);
      if (const auto found = values.find(name); found != values.end()) setenv(name, found->second.c_str(), 1);
      names_.push_back(name);
    }
  }
  ~Variables() {
    for (const std::string& name : names_) {
      unsetenv(name.c_str());
      if (const auto found = own_.find(name); found != own_.end()) setenv(name.c_str(), found->second.c_str(), 1);
    }
  }
  Variables(const Variables&) = delete;
  Variables& operator=(const Variables&) = delete;

 private:
  std::vector<std::string> names_;
  std::map<std::string, std::string> own_;
};

std::optional<Launch> launch_with(const std::map<std::string, std::string>& values) {
  const Variables variables(values);
  return find_launch();
}

TEST(Launcher, IsKnownByItsVariables) {
  const auto open_mpi =
      launch_with({{"OMPI_COMM_WORLD_SIZE", "4"}, {"OMPI_COMM_WORLD_RANK", "3"}, {"OMPI_COMM_WORLD_LOCAL_SIZE", "2"}});
  ASSERT_TRUE(open_mpi);
  EXPECT_EQ(open_mpi->library, MpiLibrary::open_mpi);
  EXPECT_EQ(open_mpi->size, 4);
  EXPECT_EQ(open_mpi->rank, 3);
  EXPECT_EQ(open_mpi->local_size, 2);
  const auto mpich = launch_with({{"PMI_SIZE", "2"}, {"PMI_RANK", "1"}});
  ASSERT_TRUE(mpich);
  EXPECT_EQ(mpich->library, MpiLibrary::mpich);
  EXPECT_EQ(mpich->rank, 1);
  const auto srun = launch_with({{"PMIX_RANK", "1"}, {"SLURM_STEP_NUM_TASKS", "2"}});
  ASSERT_TRUE(srun);
  EXPECT_EQ(srun->size, 2);
}

TEST(Launcher, IsNoQueueThatRunsOneProcess) {
  EXPECT_FALSE(launch_with({}));
  EXPECT_FALSE(launch_with({{"SLURM_PROCID", "1"}, {"SLURM_NTASKS", "4"}, {"SLURM_STEP_NUM_TASKS", "4"}}));
  EXPECT_FALSE(launch_with({{"PMIX_RANK", "0"}, {"SLURM_STEP_NUM_TASKS", "1"}}));
  EXPECT_FALSE(launch_with({{"PMIX_RANK", "0"}}));
  EXPECT_FALSE(launch_with({{"OMPI_COMM_WORLD_SIZE", "many"}}));
}

TEST(Launcher, IsIgnoredWithAnEmptyPlugin) {
  EXPECT_FALSE(launch_with({{"OMPI_COMM_WORLD_SIZE", "4"}, {"RELUME_MPI_PLUGIN", ""}}));
  EXPECT_TRUE(launch_with({{"OMPI_COMM_WORLD_SIZE", "4"}, {"RELUME_MPI_PLUGIN", "relume-mpi.so"}}));
}

}  // namespace
}  // namespace relume::ranks

// The experiments, one file each. experiment.cpp lists them.
#pragma once

#include "experiments/experiment.h"

namespace relume {

Experiment adaptive_sampling_experiment();
Experiment reprojection_experiment();
Experiment combination_experiment();

}  // namespace relume

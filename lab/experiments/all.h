// Declares the experiments, one per file. experiment.cpp lists them.
#pragma once

#include "experiments/experiment.h"

namespace relume {

Experiment adaptive_sampling_experiment();
Experiment proportional_sampling_experiment();
Experiment reprojection_experiment();
Experiment combination_experiment();
Experiment bdpt_quality_experiment();
Experiment bdpt_cost_experiment();
Experiment bmfr_experiment();
Experiment light_selection_experiment();
Experiment guiding_experiment();
Experiment vlc_adaptation_experiment();
Experiment cdq_adaptation_experiment();
Experiment mcpg_adaptation_experiment();
Experiment guide_cost_experiment();
Experiment psf_error_experiment();
Experiment psf_bias_experiment();
Experiment psf_variance_experiment();
Experiment psf_frametime_experiment();
Experiment apg_depth_experiment();
Experiment interactive_experiment();
Experiment upscaling_experiment();
Experiment vcm_quality_experiment();
Experiment restir_di_speed_experiment();
Experiment restir_bias_experiment();
Experiment restir_correlation_experiment();
Experiment restir_pt_shifts_experiment();
Experiment scale_experiment();
Experiment no_reuse_experiment();
Experiment readapt_experiment();
Experiment together_experiment();
Experiment indirect_experiment();
Experiment caustics_experiment();
Experiment sharc_cost_experiment();

}  // namespace relume

// Time of a denoiser within whole frames.
#pragma once

#include <string_view>

#include <benchmark/benchmark.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume::testing {

/// Renders frames of 1280 × 720 pixels on all threads. Reports the passes whose names begin with `prefix`, as manual
/// time.
inline void bench_denoiser(benchmark::State& state, DenoiseChoice denoiser, std::string_view prefix) {
  RenderSettings settings;
  settings.width = 1280;
  settings.height = 720;
  settings.path.max_bounces = 1;
  settings.denoise = denoiser;
  Session session(find_builtin_scene("cornell")->build(), settings);
  double before = 0;
  for (auto _ : state) {
    session.render_frame();
    double seconds = 0;
    for (const PassTime& pass : session.statistics().passes)
      seconds += pass.name.starts_with(prefix) ? pass.seconds : 0;
    state.SetIterationTime(seconds - before);
    before = seconds;
  }
}

}  // namespace relume::testing

// relume_ray_replay SCENE [--SETTING VALUE]...: measures Embree's share of the frame time. Records the rays of one
// frame, then times frames and replays of those rays in turn, with one and with two threads (docs/performance.md).
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/scene_source.h"
#include "core/clock.h"
#include "embree_recorder.h"
#include "frame/launch.h"
#include "relume/error.h"
#include "render/session.h"
#include "render/settings.h"

namespace relume {
namespace {

constexpr int kRounds = 5;
constexpr int kFramesPerRound = 3;
constexpr int kThreads[] = {1, 2};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Replays part of the log per tile, distributed to threads like the tiles of a frame.
struct ReplayKernel {
  const QueryLog* log = nullptr;
  RTCScene scene = nullptr;
  std::atomic<uint64_t>* sum = nullptr;
  uint32_t tiles = 0;
  uint32_t tile_size = 0;

  void operator()(uint32_t x, uint32_t) const {
    const uint64_t tile = x / tile_size;
    const uint64_t size = log->size();
    *sum += log->replay(scene, tile * size / tiles, (tile + 1) * size / tiles);
  }
  void operator()(const Tile& tile) const { (*this)(tile.x0, tile.y0); }
};

struct Recording {
  QueryLog log;
  uint64_t sum = 0;
  uint64_t samples = 0;
  uint32_t tiles = 0;
};

Recording record(const Scene& scene, RenderSettings settings) {
  settings.threads = 1;
  Session session(scene, settings);
  Recording recording;
  record_queries(&recording.log);
  session.render_frame();
  recording.sum = recorded_sum();
  record_queries(nullptr);
  recording.samples = session.statistics().samples;
  const uint64_t rays = session.statistics().rays;
  if (rays != recording.log.rays()) {
    throw Error(
        fmt::format("the frame traced {} rays, but {} passed the recorder; make every Embree query pass the recorder",
                    rays, recording.log.rays()));
  }
  recording.tiles = static_cast<uint32_t>((settings.width + 15) / 16 * ((settings.height + 15) / 16));
  return recording;
}

/// Times with one number of threads, in seconds.
struct Times {
  std::vector<double> frame_s;
  std::vector<double> replay_s;
};

/// Times frames and replays in turn. Uses a separate session, because only one at a time may set TBB's threads.
void time_round(const Scene& scene, RenderSettings settings, const Recording& recording, int threads, Times& times) {
  constexpr uint32_t kTileSize = 16;  // same as the backend's
  settings.threads = threads;
  Session session(scene, settings);
  Backend backend(threads);
  session.render_frame();  // warms up and sets the last queried scene
  for (int i = 0; i < kFramesPerRound; ++i) {
    double start = now_s();
    session.render_frame();
    times.frame_s.push_back(now_s() - start);
    std::atomic<uint64_t> sum{0};
    const ReplayKernel kernel{&recording.log, last_queried_scene(), &sum, recording.tiles, kTileSize};
    start = now_s();
    launch(backend, "replay", kernel, recording.tiles * kTileSize, 1);
    times.replay_s.push_back(now_s() - start);
    if (sum != recording.sum) throw Error("the replayed rays found something else than the frame's");
  }
}

AllSettings settings_of(const std::vector<std::string>& arguments, const Scene& scene) {
  SettingSources sources{.scene_json = scene.settings_json, .scene_place = arguments[0]};
  for (size_t i = 1; i + 1 < arguments.size(); i += 2) {
    if (!arguments[i].starts_with("--")) throw Error(arguments[i] + " is not a setting; write --NAME VALUE");
    sources.flags.emplace_back(arguments[i].substr(2), arguments[i + 1]);
  }
  return resolve(sources);
}

void print(const RenderSettings& settings, const Recording& recording, const Times (&times)[2]) {
  const auto samples = static_cast<double>(recording.samples);
  const QueryLog& log = recording.log;
  fmt::print("{}x{}, {} bounces; rays a sample: {:.3f} (camera and path {:.3f}, shadow {:.3f})\n", settings.width,
             settings.height, settings.path.max_bounces, static_cast<double>(log.rays()) / samples,
             static_cast<double>(log.nearest_rays) / samples, static_cast<double>(log.shadow_rays) / samples);
  fmt::print("threads   frame ms   replay ms   replay/frame   frame Mrays/s   replay Mrays/s\n");
  double frame_s[2];
  double replay_s[2];
  for (int i = 0; i < 2; ++i) {
    frame_s[i] = median(times[i].frame_s);
    replay_s[i] = median(times[i].replay_s);
    const double mrays = static_cast<double>(log.rays()) * 1e-6;
    fmt::print("{:7} {:10.1f} {:11.1f} {:13.1f}% {:15.2f} {:16.2f}\n", kThreads[i], frame_s[i] * 1e3, replay_s[i] * 1e3,
               100 * replay_s[i] / frame_s[i], mrays / frame_s[i], mrays / replay_s[i]);
  }
  const double frame_gain = frame_s[0] / frame_s[1];
  const double replay_gain = replay_s[0] / replay_s[1];
  fmt::print("from one thread to two: frame {:.3f}x, replay {:.3f}x, ratio {:.3f}\n", frame_gain, replay_gain,
             frame_gain / replay_gain);
}

void run(const std::vector<std::string>& arguments) {
  if (arguments.size() % 2 != 1) throw Error("usage: relume_ray_replay SCENE [--SETTING VALUE]...");
  Scene scene = cli::open_scene(arguments[0]);
  const AllSettings settings = settings_of(arguments, scene);
  apply(settings.scene, scene);
  const Recording recording = record(scene, settings.render);
  Times times[2];
  for (int round = 0; round < kRounds; ++round) {
    for (int i = 0; i < 2; ++i) time_round(scene, settings.render, recording, kThreads[i], times[i]);
  }
  print(settings.render, recording, times);
}

}  // namespace
}  // namespace relume

int main(int argc, char** argv) {
  try {
    relume::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "relume_ray_replay: {}\n", error.what());
    return 1;
  }
}

#include <memory>

#include "cli/command.h"
#include "cli/render_job.h"
#include "render/settings.h"
#include "scene_io/scene_format.h"

namespace relume::cli {
namespace {

std::vector<Option> declare(RenderOptions& o) {
  return {
      {{"output", &o.output,
        "File to write: .exr or .hdr (linear radiance), .png, .jpg or .tga (tone-mapped); with --frames also .mp4 or "
        ".y4m "
        "(through ffmpeg)"},
       "FILE",
       'o',
       Completion::file},
      {{"aov", &o.aov, "Additional layers of the EXR, separated by commas: albedo,normal,depth,motion,variance …"},
       "LIST"},
      {{"crop", &o.crop,
        "Render only this window, bit-identical to that part of the full image; an EXR keeps the size of the full "
        "image, other files contain only the window"},
       "X,Y,W,H"},
      {{"ocio", &o.ocio,
        "View of an OpenColorIO configuration for PNG, JPEG, TGA and videos; replaces the tone map, even one set by "
        "the scene, --preset or --settings"},
       "CONFIG:VIEW",
       0,
       Completion::file},
      {{"frames", &o.frames,
        "Render these frames of the animation; the frame number replaces #### or %04d in FILE, or is inserted before "
        "its extension"},
       "A-B"},
      {{"sample-range", &o.sample_range,
        "Render only these samples of each pixel, both included, from a multiple of 4 on; the EXR holds their exact "
        "sums for relume merge"},
       "A-B"},
      {{"fps", &o.fps, "Frames per second of --frames", {.min = 0.001, .max = 100000}}},
      {{"warmup",
        &o.warmup,
        "Under mpirun with --frames: frames that a rank renders before its first image, so that techniques that use "
        "earlier frames have them",
        {.min = 0, .max = 10000}}},
      {{"preset", &o.preset, "Named settings; flags override them"}, "NAME", 0, Completion::preset},
      {{"settings", &o.settings_file, "Settings from a JSON file, or from an EXR that relume rendered"},
       "FILE",
       0,
       Completion::file},
      {{"stats", &o.stats, "Write times, counters and memory as JSON"}, "FILE.json", 0, Completion::file},
      {{"resume", &o.checkpoint, "Continue from this checkpoint if it exists, and keep it up to date"},
       "FILE.ckpt",
       0,
       Completion::file},
      {{"checkpoint-interval",
        &o.checkpoint_interval_s,
        "Time between checkpoints",
        {.min = 0, .max = 1e8, .unit = "s"}}},
      {{"display", &o.display, "Show the image in a running tev viewer; the default port is 14158"}, "HOST:PORT"},
  };
}

}  // namespace

Command render_command(Verbosity& verbosity) {
  // Both live as long as the command.
  const auto options = std::make_shared<RenderOptions>();
  const auto defaults = std::make_shared<AllSettings>();
  Command command{
      .name = "render",
      .summary = "Render a scene to an image, or an animation to images.",
      .examples =
          {
              {"relume render cornell -o out.png", "a built-in scene, 64 samples per pixel"},
              {"relume render scene.glb -o out.exr --spp 256 --aov albedo,normal,depth", "linear radiance with layers"},
              {"relume render scene.glb -o out.exr --error 0.01 --time 10min",
               "up to an error of 0.01, for ten minutes at most"},
              {"relume render scene.glb -o out.exr --spp 4096 --resume out.ckpt", "can be interrupted and continued"},
              {"relume render cornell -o part1.exr --sample-range 0-127", "a part of the samples, for relume merge"},
              {"mpirun -n 4 relume render scene.glb -o out.exr --spp 4096 --resume out.ckpt", "on four ranks"},
              {"relume render turntable -o frames/####.png --frames 0-47 --fps 24", "two seconds of an animation"},
              {"relume render turntable -o film.mp4 --frames 0-47 --spp 8 --history reproject", "the same as a video"},
              {"relume render scene.gltf -o out.png --camera Door --env sky.hdr --exposure -1",
               "another view and light"},
          },
      .arguments = {{"SCENE", &options->scene, scene_format_names() + " file, or a built-in scene (`relume scenes`)",
                     true, Completion::scene}},
      .options = declare(*options),
      .setting_groups = setting_groups(*defaults),
      .setting_flags = &options->flags,
      .run = [options, defaults, &verbosity] { return run_render(*options, verbosity); },
      .essentials = {"output", "width", "height", "spp", "camera", "env", "exposure", "denoise", "frames", "preset"},
  };
  for (Option& option : verbosity_options(verbosity)) command.options.push_back(std::move(option));
  return command;
}

}  // namespace relume::cli

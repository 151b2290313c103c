#!/usr/bin/env python3
"""Tests the program's outputs: images, layers, metadata, statistics, sequences, completion."""

import json
import os
import socket
import struct
import subprocess
import threading
import unittest

from program import SMALL, ProgramTest, exr_channels, exr_strings, png_size, run, write_gltf

STATS_KEYS = {"load_s", "build_s", "accel_s", "render_s", "samples", "paths", "rays", "nonfinite_samples", "threads", "peak_memory_bytes", "passes"}
METRICS_KEYS = {"mse", "rel_mse", "mae", "mape", "flip", "mean_a", "mean_b"}
LAYERS = {
    "albedo": ["albedo.B", "albedo.G", "albedo.R"],
    "normal": ["normal.X", "normal.Y", "normal.Z"],
    "depth": ["depth.Z"],
    "motion": ["motion.X", "motion.Y"],
    "variance": ["variance.Y"],
    "heatmap": ["heatmap.Y"],
}


class TevViewer(threading.Thread):
    """Listens like the tev viewer, and stores received messages (tev's ipc protocol: length, operation, fields)."""

    def __init__(self):
        super().__init__(daemon=True)
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self.socket.getsockname()[1]
        self.messages = []
        self.start()

    def run(self):
        connection = self.socket.accept()[0]
        data = b""
        while block := connection.recv(1 << 16):
            data += block
            while len(data) >= 4 and len(data) >= struct.unpack_from("<I", data)[0]:
                size = struct.unpack_from("<I", data)[0]
                self.messages.append((data[4], data[5:size]))
                data = data[size:]


class Outputs(ProgramTest):
    def test_a_comparison_needs_only_a_scene(self):
        self.succeed("compare", "cornell", *SMALL, "--spp", "1", "--repeat", "1", "--reference-spp", "2", "--cache-dir", "cache")
        results = json.loads((self.folder / "cornell-compare/compare.json").read_text())
        self.assertEqual([c["name"] for c in results["contenders"]], ["default", "interactive"])
        self.assertEqual(results["machine"]["Device"], "processor")
        self.assertNotEqual(run("compare", str(self.folder / "lost.glb"), cwd=self.folder).returncode, 0)
        self.assertFalse((self.folder / "lost-compare").exists())

    def test_layers_and_combinations_are_those_of_the_settings_that_a_scene_brings(self):
        scene = {"scene": "builtin:furnace", "settings": {"denoise": "svgf", "reproject.method": "backward"}}
        (self.folder / "view.json").write_text(json.dumps(scene))
        self.succeed("render", "view.json", "-o", "out.exr", *SMALL, "--spp", "1", "--aov", "denoised")
        self.succeed("render", "view.json", "-o", "out.exr", *SMALL, "--spp", "1", "--estimator", "bdpt", "--history", "reproject")
        self.assertEqual(run("render", "view.json", "-o", "no.exr", *SMALL, "--aov", "denoisd", cwd=self.folder).returncode, 2)

    def test_a_pilot_alone_is_no_image(self):
        pilot = ["--allocation", "adaptive", "--adaptive.pilot", "--adaptive.max", "8", "--adaptive.min", "2"]
        refused = run("render", "furnace", "-o", "no.png", *map(str, SMALL), *pilot, "--spp", "8", cwd=self.folder)
        self.assertEqual((refused.returncode, "excludes the samples of the first 8 frames" in refused.stderr), (2, True), refused.stderr)
        self.succeed("render", "furnace", "-o", "out.png", *SMALL, *pilot, "--spp", "9")

    def test_a_tev_viewer_gets_the_image(self):
        viewer = TevViewer()
        self.succeed("render", "furnace", "-o", "out.exr", *SMALL, "--spp", "2", "--display", viewer.address)
        viewer.join(20)
        self.assertFalse(viewer.is_alive(), "the connection was not closed")
        (create, image), *updates = viewer.messages
        self.assertEqual(create, 4)
        name, rest = image[1:].split(b"\0", 1)
        self.assertEqual((name, struct.unpack_from("<iii", rest), rest[12:]), (b"furnace", (24, 18, 3), b"R\0G\0B\0"))
        pixels = {}
        for operation, body in updates:
            self.assertEqual(operation, 6)
            name, rest = body[1:].split(b"\0", 1)
            x, y, width, height = struct.unpack_from("<4i", rest, 4 + 6)
            values = struct.unpack(f"<{3 * width * height}f", rest[4 + 6 + 16 + 48:])
            for i in range(width * height):
                pixels[x + i % width, y + i // width] = values[3 * i:3 * i + 3]
        self.assertEqual(len(pixels), 24 * 18)
        mean = sum(value[1] for value in pixels.values()) / len(pixels)
        self.assertAlmostEqual(mean, json.loads(self.succeed("metrics", "out.exr", "out.exr", "--json").stdout)["mean_a"][1], delta=1e-4)

    def test_every_kind_of_image(self):
        for kind in ("exr", "hdr", "png", "jpg", "jpeg", "tga"):
            self.succeed("render", "cornell", "-o", f"out.{kind}", *SMALL, "--spp", "2")
            self.assertIn("24 x 18", self.succeed("info", f"out.{kind}").stdout)
        self.assertEqual(len(self.files()), 6)  # and no temporary file
        self.assertEqual(png_size(self.folder / "out.png"), (24, 18))

    def test_layers_have_conventional_names(self):
        self.succeed("render", "cornell", "-o", "out.exr", *SMALL, "--spp", "2", "--aov", ",".join(LAYERS))
        channels = sorted(["R", "G", "B"] + sum(LAYERS.values(), []))
        self.assertEqual(exr_channels(self.folder / "out.exr"), channels)
        info = self.succeed("info", "out.exr").stdout
        for channel in channels:
            self.assertIn(f" {channel} from ", info)

    def test_cells_show_as_layers_and_in_the_statistics(self):
        # Lower and upper bound of each layer for the box after 12 frames.
        bounds = {"identity": (0, 1 << 32), "level": (-8, 2), "count": (0, 4096), "age": (0, 12), "variance": (0, 1e4),
                  "survival": (0, 1), "blend": (0, 1), "termination": (0, 9), "occupancy": (0, 1)}
        names = ",".join(f"cell-{name}" for name in bounds)
        self.succeed("render", "cornell", "-o", "out.exr", "--width", "96", "--height", "72", "--spp", "12", "--cache", "apsf+apg",
                     "--history", "none", "--apsf.min-samples", "16", "--aov", names, "--stats", "s.json")
        channels = {c["name"].split(".")[0]: c for c in json.loads(self.succeed("info", "out.exr", "--json").stdout)["channels"]}
        for name, (low, high) in bounds.items():
            channel = channels[f"cell-{name}"]
            self.assertGreaterEqual(channel["min"], low, name)
            self.assertLessEqual(channel["max"], high, name)
            self.assertLess(channel["min"], channel["max"], name)  # an unwritten layer would be constant
        self.assertEqual(channels["cell-age"]["max"], 12)
        figures = json.loads((self.folder / "s.json").read_text())["figures"]
        self.assertTrue(0 < figures["resolve.culled"] < 1, figures)
        self.assertGreaterEqual(figures["cells.probes"], 1)
        self.assertLess(figures["cells.probes"], 16)
        self.assertGreater(figures["cells.cells"], 50)
        self.assertGreater(figures["cells.occupancy"], 0)
        self.assertEqual(figures["cells.dropped"], 0)

    def test_metadata_says_how_it_was_made(self):
        self.succeed("render", "cornell", "-o", "out.exr", *SMALL, "--spp", "3", "--seed", "5", "--lights", "uniform", "--max-bounces", "4")
        strings = exr_strings(self.folder / "out.exr")
        settings = json.loads(strings["relume.settings"])
        self.assertEqual((settings["seed"], settings["max-bounces"], settings["lights"], settings["width"]), (5, 4, "uniform", 24))
        self.assertEqual(strings["relume.seed"], "5")
        self.assertEqual(strings["relume.samples_per_pixel"], "3")
        self.assertEqual(strings["relume.scene"], "cornell")
        self.assertRegex(strings["relume.scene_hash"], "^[0-9a-f]{16}$")
        self.assertLessEqual({"load_s", "build_s", "render_s"}, set(json.loads(strings["relume.timings"])))
        self.assertTrue(strings["relume.version"])
        # Each image of a sequence records its own rendering time.
        self.succeed("render", "slit", "-o", "f.exr", *SMALL, "--spp", "2", "--frames", "0-2", "--stats", "s.json")
        seconds = [json.loads(exr_strings(file)["relume.timings"])["render_s"] for file in sorted(self.folder.glob("f.*.exr"))]
        self.assertEqual(len(seconds), 3)
        self.assertAlmostEqual(sum(seconds), json.loads((self.folder / "s.json").read_text())["render_s"], delta=1e-5)

    def test_an_image_can_be_made_again_from_itself(self):
        self.succeed("render", "cornell", "-o", "a.EXR", *SMALL, "--spp", "2", "--seed", "9", "--max-bounces", "3")
        self.succeed("render", "cornell", "-o", "b.exr", "--settings", "a.EXR")
        self.assert_same_pixels("a.EXR", "b.exr")
        self.assertIn('"seed": 9', self.succeed("info", "b.exr").stdout)

    def test_statistics(self):
        self.succeed("render", "cornell", "-o", "out.exr", *SMALL, "--spp", "2", "--stats", "s.json")
        stats = json.loads((self.folder / "s.json").read_text())
        self.assertLessEqual(STATS_KEYS, set(stats))
        self.assertLess(0, stats["accel_s"])
        self.assertLess(stats["accel_s"], stats["build_s"])
        self.assertEqual(stats["samples"], 24 * 18 * 2)
        self.assertEqual(stats["threads"], 1)
        self.assertIsNone(stats["device"])
        self.assertEqual(stats["nonfinite_samples"], 0)
        self.assertGreater(stats["rays"], stats["samples"])
        self.assertGreater(stats["peak_memory_bytes"], 1 << 20)
        self.assertTrue(stats["passes"])
        self.assertGreater(sum(entry["seconds"] for entry in stats["passes"]), 0)

    def test_samples_that_are_no_numbers_are_counted_and_reported(self):
        # A sun whose radiance overflows, on a triangle in the middle of the image.
        write_gltf(self.folder / "card.gltf", {
            "cameras": [{"type": "orthographic", "orthographic": {"xmag": 4, "ymag": 4, "znear": 0.1, "zfar": 10}}],
            "nodes": [{"camera": 0, "translation": [0, 0, 1]}, {"mesh": 0}],
        })
        sun = {"type": "directional", "direction": [0, 0, -1], "intensity": 1e15, "angular_diameter_deg": 1e-12}
        (self.folder / "burst.json").write_text(json.dumps({"scene": "card.gltf", "lights": [sun]}))
        done = self.succeed("render", "burst.json", "-o", "out.exr", *SMALL, "--spp", "4", "--stats", "s.json")
        stats = json.loads((self.folder / "s.json").read_text())
        self.assertGreater(stats["nonfinite_samples"], 0)
        self.assertLess(stats["nonfinite_samples"], stats["samples"])
        self.assertRegex(done.stderr, rf"warning: {stats['nonfinite_samples']} of \d.* samples were not finite")
        for channel in json.loads(self.succeed("info", "out.exr", "--json").stdout)["channels"]:
            self.assertEqual(channel["min"], 0)  # where all samples were rejected
            self.assertLess(channel["max"], 3.5e38)

    def test_default_light_and_camera_are_reported(self):
        write_gltf(self.folder / "bare.gltf", {"nodes": [{"mesh": 0}]})
        said = self.succeed("render", "bare.gltf", "-o", "out.png", *SMALL, "--spp", "1").stderr
        self.assertIn("no light", said)
        self.assertIn("no camera", said)
        said = self.succeed("render", "cornell", "-o", "out.png", *SMALL, "--spp", "1").stderr
        self.assertNotIn("using a", said)

    def test_metrics(self):
        self.succeed("render", "cornell", "-o", "a.exr", *SMALL, "--spp", "4")
        self.succeed("render", "cornell", "-o", "b.exr", *SMALL, "--spp", "4", "--seed", "1")
        different = self.metrics("a.exr", "b.exr")
        self.assertLessEqual(METRICS_KEYS, set(different))
        self.assertGreater(different["mse"], 0)
        self.assertGreater(different["flip"], 0)
        self.assertGreater(json.loads(self.succeed("metrics", "a.exr", "b.exr", "--json", "--hdr-flip").stdout)["hdr_flip"], 0)
        same = self.metrics("a.exr", "a.exr")
        self.assertEqual([same[key] for key in ("mse", "rel_mse", "mae", "mape", "flip")], [0] * 5)
        self.assertEqual(same["mean_a"], same["mean_b"])

    def test_info_for_scripts(self):
        scene = json.loads(self.succeed("info", "cornell", "--json").stdout)
        self.assertGreater(scene["triangles"], 0)
        self.assertEqual(len(scene["cameras"]), 1)
        self.succeed("render", "cornell", "-o", "a.exr", *SMALL, "--spp", "1", "--seed", "5")
        image = json.loads(self.succeed("info", "a.exr", "--json").stdout)
        self.assertEqual((image["width"], image["height"]), (24, 18))
        self.assertEqual(sorted(c["name"] for c in image["channels"]), ["B", "G", "R"])
        self.assertEqual(image["attributes"]["relume.seed"], "5")

    def test_seed_and_threads(self):
        for name, flags in {"a": ["--threads", "1"], "b": ["--threads", "2"], "c": ["--threads", "5"], "d": ["--threads", "1", "--seed", "2"]}.items():
            self.succeed("render", "cornell-glass", "-o", f"{name}.exr", "--width", "50", "--height", "40", "--spp", "3", *flags)
        self.assert_same_pixels("a.exr", "b.exr")
        self.assert_same_pixels("a.exr", "c.exr")
        self.assertGreater(self.metrics("a.exr", "d.exr")["mse"], 0)

    def write_moving_card(self):
        """Writes moving.json: a small card in front of a wall 9 m away. From a distance of 1 m, it moves right at 0.5
        m/s and away at 1 m/s. A metre is nine pixels of 24 × 18."""
        write_gltf(self.folder / "card.gltf", {
            "nodes": [{"mesh": 0, "name": "card", "scale": [0.2, 0.2, 1]}, {"mesh": 0, "name": "wall", "scale": [10, 10, 1], "translation": [0, 0, -8]}],
        })
        keys = [{"time": 0, "translation": [-0.5, 0, 0]}, {"time": 2, "translation": [0.5, 0, -2]}]
        camera = {"eye": [0, 0, 1], "target": [0, 0, 0], "projection": "orthographic", "half_height": 1}
        scene = {"scene": "card.gltf", "camera": camera, "environment": {"constant": 1}, "nodes": {"card": {"keys": keys}}}
        (self.folder / "moving.json").write_text(json.dumps(scene))

    def bounds(self, file):
        """Minimum and maximum of each channel."""
        channels = json.loads(self.succeed("info", file, "--json").stdout)["channels"]
        return {channel["name"]: (channel["min"], channel["max"]) for channel in channels}

    def assert_bounds(self, found, least, greatest):
        self.assertAlmostEqual(found[0], least, places=4)
        self.assertAlmostEqual(found[1], greatest, places=4)

    def test_sequence_moves(self):
        # Depth and motion have no noise here, so that they show the motion alone.
        self.write_moving_card()
        for fps in (2, 4):
            self.succeed("render", "moving.json", "-o", f"at{fps}.###.exr", *SMALL, "--spp", "4", "--frames", "0-2", "--fps", fps, "--aov", "depth,motion")
            for frame in range(3):
                with self.subTest(fps=fps, frame=frame):
                    time_s = frame / fps
                    sequence = self.bounds(f"at{fps}.{frame:03}.exr")
                    self.assert_bounds(sequence["depth.Z"], 1 + time_s, 9)
                    self.assert_bounds(sequence["motion.X"], 0, 0.5 / fps * 9 if frame > 0 else 0)
                    self.assert_bounds(sequence["motion.Y"], 0, 0)
                    self.succeed("render", "moving.json", "-o", "still.exr", *SMALL, "--spp", "4", "--scene-time", time_s, "--aov", "depth")
                    self.assertEqual(self.bounds("still.exr")["depth.Z"], sequence["depth.Z"])
                    self.assert_same_pixels("still.exr", f"at{fps}.{frame:03}.exr")

    def test_a_single_frame_equals_that_of_the_sequence(self):
        self.succeed("render", "slit", "-o", "f.###.exr", *SMALL, "--spp", "4", "--frames", "0-2", "--fps", "2", timeout=240)
        self.assertEqual(self.files(), ["f.000.exr", "f.001.exr", "f.002.exr"])
        self.succeed("render", "slit", "-o", "alone.exr", *SMALL, "--spp", "4", "--frames", "2-2", "--fps", "2")
        self.assert_same_pixels("f.002.exr", "alone.0002.exr")

    def test_motion_is_zero_after_the_last_key(self):
        self.write_moving_card()  # its last key is at 2 s
        self.succeed("render", "moving.json", "-o", "f.###.exr", *SMALL, "--spp", "4", "--frames", "3-6", "--fps", "2", "--aov", "motion")
        for frame, most in {4: 2.25, 5: 0, 6: 0}.items():
            self.assert_bounds(self.bounds(f"f.{frame:03}.exr")["motion.X"], 0, most)

    def test_quiet_is_silent(self):
        done = self.succeed("render", "cornell", "-o", "out.png", *SMALL, "--spp", "2", "--quiet")
        self.assertEqual((done.stdout, done.stderr), ("", ""))
        self.assertEqual(self.succeed("info", "cornell", "-v", "-q").stderr, "")
        self.assertIn("loaded cornell in", self.succeed("info", "cornell", "-v").stderr)

    def test_progress_goes_to_standard_error_without_control_codes(self):
        done = self.succeed("render", "cornell", "-o", "out.png", *SMALL, "--spp", "2", "--verbose")
        self.assertEqual(done.stdout, "")
        self.assertIn("out.png", done.stderr)
        self.assertNotIn("\x1b", done.stderr)
        self.assertNotIn("\r", done.stderr)

    def test_scenes_can_be_listed_exported_and_read(self):
        listed = self.succeed("scenes").stdout
        for name in ("cornell", "cornell-glass", "corridor", "warehouse", "mine", "cover", "turntable", "slit", "door", "city", "furnace"):
            self.assertIn(name, listed)
        for file in ("c.glb", "c.gltf"):
            self.succeed("export", "cornell", "-o", file)
            self.succeed("render", file, "-o", file + ".exr", *SMALL, "--spp", "2")
        self.assert_same_pixels("c.glb.exr", "c.gltf.exr")

    def test_environment(self):
        self.succeed("render", "furnace", "-o", "half.exr", *SMALL, "--spp", "8", "--env", "0.5,0.25,0.125")
        mean = self.metrics("half.exr", "half.exr")["mean_a"]
        for value, expected in zip(mean, (0.5, 0.25, 0.125)):
            self.assertAlmostEqual(value / expected, 1, delta=0.01)

    def test_help_and_version(self):
        self.assertIn("relume", self.succeed("--help").stdout)
        for command in ("render", "view", "serve", "scenes", "export", "info", "metrics", "merge", "compare", "experiment run", "survey", "settings", "devices", "man", "completion"):
            text = self.succeed(*command.split(), "--help").stdout
            self.assertLess(text.index("Examples:"), text.index("Usage:"))
        self.assertRegex(self.succeed("--version").stdout, r"\d+\.\d+\.\d+")
        self.assertIn("Embree", self.succeed("devices").stdout)

    def test_timing(self):
        before = self.files()
        done = self.succeed("compare", "cornell", *SMALL, "--techniques", "default,psf", "--timing", "4")
        rows = [line.split(",") for line in done.stdout.splitlines()]
        self.assertEqual(rows[0][:7], ["name", "ms", "ms_low", "ms_high", "ratio", "ratio_low", "ratio_high"])
        self.assertEqual([row[0] for row in rows[1:]], ["default", "psf"])
        self.assertEqual(rows[1][4], "1")
        self.assertGreater(float(rows[2][1]), 0)
        self.assertEqual(self.files(), before)

    def test_completion(self):
        script = self.folder / "relume.bash"
        script.write_text(self.succeed("completion", "bash").stdout)
        subprocess.run(["bash", "-n", script], check=True)
        for words, expected in (("ren", ["render"]), ("render corn", None), ("render x --lig", ["--lights"]), ("render x --lights p", ["power"])):
            typed = f"source {script}; compopt() {{ :; }}; COMP_WORDS=(relume {words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _relume; printf '%s\\n' \"${{COMPREPLY[@]}}\""
            offered = subprocess.run(["bash", "--norc", "-c", typed], cwd=self.folder, capture_output=True, text=True, check=True).stdout.split()
            if expected:
                self.assertEqual(offered, expected)
            else:
                self.assertIn("cornell", offered)

    def test_output_that_cannot_be_completed_leaves_the_old_one(self):
        (self.folder / "out.exr").write_bytes(b"old")
        done = run("render", "cornell", "-o", "out.exr", *SMALL, "--spp", "1", "--camera", "none", cwd=self.folder)
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual((self.folder / "out.exr").read_bytes(), b"old")

    def test_video_gets_every_frame(self):
        # The fake encoder stores the raw frames.
        env = self.with_encoder('echo "$@" > bin/arguments; for last; do :; done; cat > "$last"')
        self.succeed("render", "turntable", "-o", "out.mp4", *SMALL, "--spp", "1", "--frames", "0-3", env=env)
        self.assertEqual((self.folder / "out.mp4").stat().st_size, 4 * 24 * 18 * 3)
        self.assertEqual(self.files(), ["bin", "out.mp4"])
        arguments = (self.folder / "bin" / "arguments").read_text()
        self.assertIn("out_color_matrix=bt709", arguments)  # default of players for high definition
        self.assertIn("-colorspace bt709", arguments)

    def test_video_that_cannot_be_encoded_leaves_nothing(self):
        env = self.with_encoder("exit 3")
        done = run("render", "turntable", "-o", "out.mp4", *SMALL, "--spp", "1", "--frames", "0-3", cwd=self.folder, env=env)
        self.assertEqual(done.returncode, 1)
        self.assertIn("ffmpeg", done.stderr)
        self.assertEqual(self.files(), ["bin"])

    def test_video_needs_an_encoder(self):
        env = {**os.environ, "PATH": str(self.folder)}
        done = run("render", "turntable", "-o", "out.mp4", *SMALL, "--frames", "0-3", cwd=self.folder, env=env)
        self.assertEqual(done.returncode, 2)
        self.assertIn("install", done.stderr)


if __name__ == "__main__":
    unittest.main()

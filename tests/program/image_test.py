#!/usr/bin/env python3
"""Tests how images are displayed: windows (--crop) and views of OpenColorIO (--ocio)."""

import json
import struct
import unittest

from ocio import HALF_VIEW, is_missing
from png import png_pixels
from program import SMALL, ProgramTest, exr_header, exr_strings, run


class Images(ProgramTest):
    def test_a_window_is_cut_out_of_the_whole_image(self):
        look = [*SMALL, "--spp", "4", "--exposure", "0"]
        self.succeed("render", "cornell", "-o", "whole.png", *look)
        self.succeed("render", "cornell", "-o", "part.png", *look, "--crop", "5,4,12,9")
        _, _, channels, whole = png_pixels(self.folder / "whole.png")
        part = png_pixels(self.folder / "part.png")
        self.assertEqual(part, (12, 9, channels, [row[5 * channels:17 * channels] for row in whole[4:13]]))
        self.succeed("render", "cornell", "-o", "part.exr", *look, "--crop", "5,4,12,9", "--aov", "albedo", "--stats", "part.json")
        self.succeed("render", "cornell", "-o", "whole.exr", *look, "--stats", "whole.json")
        header = exr_header(self.folder / "part.exr")
        self.assertEqual([struct.unpack("<4i", header[f"{name}Window"][1]) for name in ("data", "display")], [(5, 4, 16, 12), (0, 0, 23, 17)])
        self.assertEqual(exr_strings(self.folder / "part.exr")["relume.crop"], "5,4,12,9")
        self.assertNotIn("relume.crop", exr_strings(self.folder / "whole.exr"))
        for name, crop in (("part.json", [5, 4, 12, 9]), ("whole.json", None)):
            self.assertEqual(json.loads((self.folder / name).read_text())["crop"], crop)
        done = run("metrics", "part.exr", "whole.exr", cwd=self.folder)
        self.assertIn("part.exr stores the window 5,4,12,9, but whole.exr stores the whole image", done.stderr)
        self.assertNotEqual(done.returncode, 0)
        self.succeed("render", "cornell", "-o", "other.exr", *look, "--crop", "6,4,12,9")
        self.assertIn("other.exr stores the window 6,4,12,9", run("metrics", "part.exr", "other.exr", cwd=self.folder).stderr)
        same = json.loads(self.succeed("metrics", "part.exr", "part.exr", "--json").stdout)
        self.assertEqual(same["mse"], 0)
        for window, sentence in (("5,4,12", "must be left, top, width and height"), ("5,4,20,9", "is not within the image of 24x18 pixels")):
            done = run("render", "cornell", "-o", "no.png", *map(str, look), "--crop", window, cwd=self.folder)
            self.assertIn(sentence, done.stderr)
            self.assertNotEqual(done.returncode, 0)
        done = run("render", "cornell", "-o", "no.png", *map(str, look), "--crop", "0,0,9,9", "--denoise", "svgf", cwd=self.folder)
        self.assertIn("--crop does not combine with a denoiser", done.stderr)

    def test_a_scene_file_requests_a_window(self):
        (self.folder / "part.pbrt").write_text(
            'Film "rgb" "integer xresolution" 24 "integer yresolution" 18 "integer pixelbounds" [5 17 4 13]\n'
            'LookAt 0 1 4  0 0 0  0 1 0\nCamera "perspective"\nWorldBegin\nLightSource "infinite"\nShape "sphere"\n')
        look = ["--spp", "2", "--exposure", "0"]
        done = self.succeed("render", "part.pbrt", "-o", "part.png", *look)
        self.assertIn("part.pbrt requests the crop 5,4,12,9; --crop 0,0,24,18 renders the whole image", done.stderr + done.stdout)
        self.succeed("render", "part.pbrt", "-o", "whole.png", *look, "--crop", "0,0,24,18")
        _, _, channels, whole = png_pixels(self.folder / "whole.png")
        self.assertEqual(png_pixels(self.folder / "part.png"),
                         (12, 9, channels, [row[5 * channels:17 * channels] for row in whole[4:13]]))
        self.succeed("render", "part.pbrt", "-o", "larger.png", *look, "--width", "48", "--height", "36")
        self.assertEqual(png_pixels(self.folder / "larger.png")[:2], (24, 18))
        done = self.succeed("render", "part.pbrt", "-o", "denoised.png", *look, "--denoise", "svgf")
        self.assertIn("but the whole image is rendered: --crop does not combine with a denoiser", done.stderr + done.stdout)
        self.assertEqual(png_pixels(self.folder / "denoised.png")[:2], (24, 18))

    def test_a_view_of_opencolorio_replaces_the_tone_map(self):
        (self.folder / "half.ocio").write_text(HALF_VIEW)
        look = [*SMALL, "--spp", "2", "--exposure", "0"]
        done = run("render", "furnace", "-o", "half.png", *map(str, look), "--env", "1,1,1", "--ocio", "half.ocio:Half", cwd=self.folder)
        if is_missing(done):
            self.skipTest(done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        _, _, _, rows = png_pixels(self.folder / "half.png")
        self.assertEqual(set(rows[0]), {128})  # half of the background's radiance, encoded by the view
        self.assertIn("half.ocio has no linear Rec. 709 colour space; radiance is interpreted as its role scene_linear, which is 'lin'", done.stderr)
        (self.folder / "agx.json").write_text('{"tone-map": "agx"}')
        self.succeed("render", "furnace", "-o", "settings.png", *look, "--env", "1,1,1", "--ocio", "half.ocio:Half", "--settings", "agx.json")
        self.assertEqual(png_pixels(self.folder / "settings.png"), png_pixels(self.folder / "half.png"))
        for text in ("half.ocio", "half.ocio:", ":Half"):
            done = run("render", "furnace", "-o", "no.png", "--ocio", text, cwd=self.folder)
            self.assertIn(f"--ocio is '{text}', but must name a configuration and one of its views", done.stderr)
            self.assertEqual(done.returncode, 2)
        for more, sentence in ((["--ocio", "half.ocio:Filmic"], "it has Half"), (["--ocio", "half.ocio:Half", "--tone-map", "agx"], "give one of them")):
            self.assertIn(sentence, run("render", "furnace", "-o", "no.png", *map(str, look), *more, cwd=self.folder).stderr)
        self.assertIn("files store radiance", run("render", "furnace", "-o", "no.exr", "--ocio", "half.ocio:Half", cwd=self.folder).stderr)


if __name__ == "__main__":
    unittest.main()

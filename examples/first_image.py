#!/usr/bin/env python3
"""first_image.py [SCENE]: renders a scene file or a built-in scene (default: cornell) to image.png."""

import os
import sys

import relume


def main(scene_name: str = "cornell") -> None:
    scene = relume.load(scene_name) if os.path.exists(scene_name) else relume.builtin(scene_name)
    for warning in scene.warnings:
        print(warning)
    session = relume.Session(scene, 320, 180)
    ended_by = session.render_until(samples=64, progress=True)
    print(f"{session.samples:.0f} samples per pixel, ended by: {ended_by}")
    relume.write_image("image.png", relume.tone_map(session.image))


if __name__ == "__main__":
    main(*sys.argv[1:])

"""Configurations of OpenColorIO for tests."""

# Its view Half halves radiance.
HALF_VIEW = """ocio_profile_version: 1
roles: {default: lin, scene_linear: lin}
displays:
  screen:
    - !<View> {name: Half, colorspace: half}
active_displays: []
active_views: []
colorspaces:
  - !<ColorSpace>
    name: lin
  - !<ColorSpace>
    name: half
    from_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}
"""

# Its view Film reads a look-up table, luts/film.spi1d.
FILM_VIEW = HALF_VIEW.replace("roles:", "search_path: luts\nroles:").replace("Half", "Film").replace(
    "!<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}", "!<FileTransform> {src: film.spi1d}")
FILM_TABLE = "Version 1\nFrom 0 1\nLength 2\nComponents 1\n{\n0\n0.5\n}\n"


def is_missing(done):
    """Whether the process ended because its program was built without the library."""
    return "OpenColorIO, which was not found" in done.stderr

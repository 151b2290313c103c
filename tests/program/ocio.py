"""A configuration of OpenColorIO for tests."""

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


def is_missing(done):
    """Whether the process ended because its program was built without the library."""
    return "OpenColorIO, which was not found" in done.stderr

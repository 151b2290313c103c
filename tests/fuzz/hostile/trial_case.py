"""What one trial is made of."""

import dataclasses

# Cheap whatever else the arguments say.
SMALL = ["--width", "8", "--height", "6", "--spp", "1", "--threads", "1"]


@dataclasses.dataclass
class Case:
    """The program may write below made/ and cache/; whatever else is there stays as it is."""

    kind: str
    arguments: list  # str or bytes
    files: dict = dataclasses.field(default_factory=dict)  # name -> bytes
    links: dict = dataclasses.field(default_factory=dict)  # name -> target
    folders: list = dataclasses.field(default_factory=list)
    required: list = dataclasses.field(default_factory=list)  # files that exist and are not empty after success
    may_change: list = dataclasses.field(default_factory=list)  # files outside made/ that success may write
    may_stay: list = dataclasses.field(default_factory=list)  # files that failure may leave
    stdout: str = ""  # where standard output goes, if not into a file that is read
    locked: str = ""  # a folder that nothing may be written to

"""Data of a trial."""

import dataclasses

# Limits the cost of any other arguments.
SMALL = ["--width", "8", "--height", "6", "--spp", "1", "--threads", "1"]


@dataclasses.dataclass
class Case:
    """A trial. The program may write below made/ and cache/ only, and must keep the bytes of `files`."""

    kind: str
    arguments: list  # str or bytes
    files: dict = dataclasses.field(default_factory=dict)  # name -> bytes
    links: dict = dataclasses.field(default_factory=dict)  # name -> target
    folders: list = dataclasses.field(default_factory=list)
    required: list = dataclasses.field(default_factory=list)  # nonempty files after success
    may_change: list = dataclasses.field(default_factory=list)  # patterns of files outside made/ that success may change; inputs only by their names
    may_stay: list = dataclasses.field(default_factory=list)  # files that failure may leave
    refused: bool = False  # whether success is a problem
    stdout: str = ""  # destination of standard output if not captured
    locked: str = ""  # read-only folder

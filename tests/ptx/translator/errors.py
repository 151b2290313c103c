"""The error of the translator: a place in a PTX file and a sentence."""


class PtxError(Exception):
    """What the translator does not accept. `file` and `line`: where."""

    def __init__(self, file, line, message):
        super().__init__(f"{file}:{line}: {message}")

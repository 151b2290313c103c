"""Errors of relume."""


class Error(RuntimeError):
    """An unusable file, setting, value or combination.

    The message names the place, the problem and the remedy. `code` is one of "invalid-input", "invalid-handle",
    "not-found", "not-supported" and "io".
    """

    def __init__(self, message: str, code: str = "invalid-input") -> None:
        super().__init__(message)
        self.code = code

    @property
    def remedy(self) -> str:
        """What to do: the part of the message after its last semicolon; empty if the message has none."""
        _, semicolon, remedy = str(self).rpartition("; ")
        return remedy if semicolon else ""

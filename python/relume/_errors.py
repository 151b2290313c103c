"""Errors of relume."""


class Error(RuntimeError):
    """An unusable file, setting, value or combination.

    The message names the place, the problem and the remedy. `code` is one of "invalid-input", "invalid-handle",
    "not-found", "not-supported", "io" and "device".
    """

    def __init__(self, message: str, code: str = "invalid-input") -> None:
        super().__init__(message)
        self.code = code

    @property
    def remedy(self) -> str:
        """What to do, or what would be valid: the message's end, after its last semicolon or "but"; empty without either."""
        message = str(self)
        for separator in ("; ", ", but "):
            before, _, remedy = message.rpartition(separator)
            if before:
                return remedy
        return ""

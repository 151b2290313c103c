"""Suggestions for mistyped names."""

import difflib
from collections.abc import Iterable


def nearest(name: str, known: Iterable[str]) -> str:
    """The most similar known name, or an empty string if none is similar."""
    near = difflib.get_close_matches(str(name), known, n=1, cutoff=0.5)
    return near[0] if near else ""


def suggestion(name: str, known: Iterable[str]) -> str:
    """The end of a message on an unknown name: "; did you mean 'cornell'?", or all names if none is similar."""
    public = [candidate for candidate in known if not candidate.startswith("_")]
    near = nearest(name, public)
    return f"; did you mean '{near}'?" if near else f"; there are {', '.join(public)}"

"""Suggestions for mistyped names."""

import difflib
from collections.abc import Iterable


def suggestion(name: str, known: Iterable[str]) -> str:
    """"; did you mean 'cornell'?", or an empty string if no known name is similar."""
    public = [candidate for candidate in known if not candidate.startswith("_")]
    near = difflib.get_close_matches(str(name), public, n=1, cutoff=0.5)
    return f"; did you mean '{near[0]}'?" if near else ""

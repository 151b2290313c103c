"""Progress bars."""

import sys
from types import TracebackType
from typing import Any, Optional


class _TextBar:
    """A line on the terminal, where tqdm is not installed."""

    def __init__(self, total: int, unit: str) -> None:
        self.n = 0
        self._total = total
        self._unit = unit

    def update(self, count: int) -> None:
        self.n += count
        sys.stderr.write(f"\r{self.n} of {self._total} {self._unit}")
        sys.stderr.flush()

    def __enter__(self) -> "_TextBar":
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        sys.stderr.write("\n")


def progress_bar(total: int, unit: str) -> Any:
    """A context manager with update(count) and n: tqdm's bar if tqdm is installed."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _TextBar(total, unit)
    return tqdm(total=total, unit=unit)

"""One BLAS thread: sums in one order on any machine, and processes that do not crowd each other out."""

from __future__ import annotations

from contextlib import AbstractContextManager
from importlib import import_module

__all__ = ["one_thread"]


def one_thread() -> AbstractContextManager[object]:
    """Hold BLAS to one thread, from this call to the end of the context.

    Examples
    --------
    >>> with one_thread():
    ...     pass
    """
    from threadpoolctl import threadpool_limits

    # Only libraries that are already loaded are held, and SciPy brings a BLAS of its own.
    import_module("scipy.linalg")
    limits: AbstractContextManager[object] = threadpool_limits(1)
    return limits

"""Memory of large arrays that are freed goes back to the system.

The C library of Linux comes to keep blocks of up to 32 MB in its heap: the columns of an hour, of which most live for a moment. So does
what reads Parquet, which has a heap of its own.
"""

from __future__ import annotations

import contextlib
import ctypes
import sys

#: Arrays that are larger are asked of the system, one by one [bytes].
LARGE = 1 << 20
#: So much of what is smaller is kept for the next: else every prediction would ask the system anew [bytes].
KEPT = 64 << 20
#: What `mallopt` calls these.
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3


def return_large_arrays() -> None:
    """Have the C library return large arrays to the system as soon as they are freed, from now on; elsewhere nothing happens."""
    with contextlib.suppress(OSError, AttributeError, TypeError):
        library = ctypes.CDLL(None)
        library.mallopt(_MMAP_THRESHOLD, LARGE)
        library.mallopt(_TRIM_THRESHOLD, KEPT)


def return_freed() -> None:
    """Have the C library return all that was freed, small arrays between others too: what comes next asks for memory of its own."""
    if "pyarrow" in sys.modules:
        import pyarrow as pa

        pa.default_memory_pool().release_unused()
    with contextlib.suppress(OSError, AttributeError, TypeError):
        ctypes.CDLL(None).malloc_trim(0)

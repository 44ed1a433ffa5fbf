"""Files that others find whole or not at all: they are written under another name first."""

import os
import socket
import threading
from pathlib import Path


def half_written(path: Path) -> Path:
    """Where a file is written before it is there whole: of each thread of each process on each machine another one."""
    return path.with_name(f".{path.name}.{socket.gethostname()}.{os.getpid()}.{threading.get_ident()}")

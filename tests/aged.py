"""Files that were used days ago."""

import os
import time
from pathlib import Path


def aged(file: Path, days: float) -> Path:
    """The file, made if it isn't there, last used so many days ago."""
    file.touch()
    at = time.time() - days * 86400.0
    os.utime(file, (at, at))
    return file

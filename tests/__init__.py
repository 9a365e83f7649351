"""Tests; `python -m tests` runs every check.

They compute as the command line does, with one thread of linear algebra (see `tribocosim.__main__`).
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

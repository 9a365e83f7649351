"""The command `tribocosim`, also as `python -m tribocosim`."""

import gc
import os
import sys

from .packages import find_shadowed


def _open_closed_streams() -> None:
    """Standard streams that the caller closed lead nowhere; a file of a result would get their numbers."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode))  # noqa: SIM115  # as long as the process


def main() -> None:
    """Run the command line."""
    if message := find_shadowed():
        print(f"tribocosim: {message}", file=sys.stderr)
        sys.exit(2)
    from models.core.interruption import deferred, look

    _open_closed_streams()
    # Our matrices are small: threads would wait for each other longer than they compute, and the order of
    # their sums, so the last bits of results, would depend on the number of processors.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Imported modules are a million objects that stay; looking for garbage among them costs a tenth of a run.
    gc.set_threshold(50_000, 20, 20)
    with deferred():
        try:
            from .command_line import main as run

            run()
            look()
        except KeyboardInterrupt:  # while modules are imported; a command tells of it itself
            print("tribocosim: interrupted", file=sys.stderr)
            sys.exit(130)


if __name__ == "__main__":
    main()

"""The process that watches a run's calls. Standard library only: run as a script it starts at once.

Usage: watchdog_process.py FD, with FD a file of `CELLS` numbers of 8 bytes, shared with the run: a mark of
the call that goes on (0: none), the macro steps made, the time at the end of the last one (a double), and
the call that this process has interrupted. A
mark is one store for the run: the call's number, and in the upper half a one that this process takes away
when it looks. On standard input comes a line of JSON (see `Watchdog`); when that input ends, so does this
process.
"""

import json
import mmap
import os
import select
import signal
import sys
import time as clock
from pathlib import Path
from typing import Any

MARK, STEPS, TIME, INTERRUPTED, CELLS = 0, 1, 2, 3, 4
FRESH = 1 << 32
# The halves of the mark, as numbers of 4 bytes.
NUMBER, UPPER = (0, 1) if sys.byteorder == "little" else (1, 0)

CALLS = (
    "instantiation", "initialisation", "end of initialisation", "setting of inputs", "step",
    "reading of outputs", "reading of all outputs", "saving of its state", "restoring of its state",
    "freeing of a saved state", "serialising of its state", "taking of a serialised state", "end",
)  # fmt: skip

# Looks per limit, and the bounds of the time from one to the next (s).
LOOKS, SHORTEST, LONGEST = 20, 0.02, 1.0


def number_of(participant: int, call: str) -> int:
    """The number of a call, from 1 on."""
    return participant * len(CALLS) + CALLS.index(call) + 1


def message(names: list[str], number: int, limit: float, steps: int, time: float) -> str:
    """What is said of the call `number` that did not return."""
    participant, call = divmod(number - 1, len(CALLS))
    when = f" after t = {time:.9g} s (macro step {steps + 1})" if steps >= 0 else ""
    return (
        f"{names[participant]}: the {CALLS[call]} did not return within {limit:g} s{when}; look at what that "
        "participant waits for, or raise call_time_limit"
    )


def watch(shared: Any, setup: dict[str, Any]) -> None:
    """Until standard input ends, or the run had to be ended."""
    cells, halves, times = shared.cast("q"), shared.cast("i"), shared.cast("d")
    limit, grace, run = setup["limit"], setup["grace"], os.getppid()
    pause = min(max(limit / LOOKS, SHORTEST), LONGEST)
    looked, lasted, interrupted = clock.monotonic(), 0.0, False
    while not select.select([0], [], [], pause)[0]:
        # Where both processes were stopped for a while, that does not count.
        now = clock.monotonic()
        lasted += min(now - looked, 2.0 * pause)
        looked = now
        if halves[UPPER] or not halves[NUMBER]:
            halves[UPPER] = 0
            lasted, interrupted = 0.0, False
        elif lasted > limit + grace:
            text = message(setup["names"], halves[NUMBER], limit, cells[STEPS], times[TIME])
            setup["summary"]["macro_steps"] = max(0, cells[STEPS])
            _end(run, text, setup)
            return
        elif lasted > limit and not interrupted:
            cells[INTERRUPTED] = halves[NUMBER]
            os.kill(run, signal.SIGUSR1)
            interrupted = True


def _end(run: int, text: str, setup: dict[str, Any]) -> None:
    """Put the message where the run would have put it, and end the run."""
    text = f"incomplete: {text}"
    path = Path(setup["path"])
    path.write_text(json.dumps(setup["summary"] | {"message": text}, indent=2) + "\n", "utf-8")
    shown = "\x1b[?25h\n" if sys.stderr.isatty() else ""  # the bar has hidden the cursor
    print(f"{shown}tribocosim: {text}", file=sys.stderr, flush=True)
    os.kill(run, signal.SIGQUIT)


def main() -> None:
    shared = mmap.mmap(int(sys.argv[1]), 8 * CELLS)
    line = b""
    while not line.endswith(b"\n"):
        if not (more := os.read(0, 1 << 16)):
            return
        line += more
    watch(memoryview(shared), json.loads(line))


if __name__ == "__main__":
    main()

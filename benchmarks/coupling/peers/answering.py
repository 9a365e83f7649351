"""The side of a peer's own process: jobs in, answers out."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from typing import Any

ANSWER = "ANSWER "
# simulate(job): the outputs at every sample.
Simulate = Callable[[dict[str, Any]], list[list[float]]]


def answer(simulate: Simulate) -> None:
    """Answer the jobs on standard input, a JSON line each, and end the process."""
    for line in sys.stdin:
        job = json.loads(line)
        try:
            said: dict[str, Any] = {"values": simulate(job)}
        except (ImportError, OSError) as error:
            say({"missing": str(error)})
            break
        except Exception as error:
            said = {"failed": f"{type(error).__name__}: {error}"}
        say(said)
    # Some tools abort when the interpreter takes their FMUs down; everything has been said by now.
    os._exit(0)


def say(content: dict[str, Any]) -> None:
    """One answer."""
    print(ANSWER + json.dumps(content), flush=True)

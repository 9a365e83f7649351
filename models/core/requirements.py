"""What ranges cannot say: parameters that must fit together, and start states that must fit them.

A rule is a kernel and a text, so that a component says the same wherever it runs, in Python or as machine
code.
"""

import contextlib
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..compile.kernel import kernel

# How many numbers a text may tell.
PLACES = 8
# What a text may have in braces: a number's place and its format, which Python and C share, or the word.
PLACE = re.compile(r"\{(?:([0-7]):(\.\d+)?([gfe])|(word))\}")


@dataclass(frozen=True)
class Requirement:
    """`met(p, numbers)`, or of a start `met(x, u, p, numbers)`, is a kernel on records: true where it holds.

    `require` makes one. Where it does not hold, it leaves in `numbers` those of the message `says`: {0:g}
    stands for the first, in that format, and {word} for the one of `words` that the first number counts, from
    0. The text begins with the name of a parameter or state, and says what is allowed and what to do. Rules
    are checked one by one: a rule whose terms another one forbids counts as met. ValueError for braces that
    are no place.
    """

    met: Any
    says: str
    words: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if left := re.search(r"[{}].*", PLACE.sub("", self.says)):
            raise ValueError(
                f"requirement {self.says!r}: {left[0]!r} is no place; places are such as {{0:g}}, {{7:.3f}} "
                "and {word}"
            )

    def fault(self, *records: Any) -> str | None:
        """The message for these records, or None if the requirement is met."""
        numbers = np.zeros(PLACES)
        with contextlib.suppress(
            ArithmeticError, ValueError
        ):  # where compiled code has NaN, which meets no rule
            if self.met(*records, numbers):
                return None
        word = self.words[int(numbers[0])] if self.words else ""
        return self.says.format(*numbers.tolist(), word=word)


def require(says: str, words: tuple[str, ...] = ()) -> Callable[[Callable[..., bool]], Requirement]:
    """Makes a function (p, numbers) or (x, u, p, numbers) the kernel of a `Requirement` that says this."""
    return lambda met: Requirement(kernel(met), says, words)

"""The energy ledger of a coupled run: what every power bond gives, takes, and gets from the coupling.

Both sides of a bond integrate its power inside their steps, with the inputs that they saw
(`models.core.bonds`). What arrives and was not sent has been created by the coupling.
"""

from .account import Account, lines
from .counting import Trimmed, add_counting, counting_structure
from .estimate import add_estimates
from .ledger import Ledger

__all__ = ["Account", "Ledger", "Trimmed", "add_counting", "add_estimates", "counting_structure", "lines"]

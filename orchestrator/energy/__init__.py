"""The energy ledger of a coupled run: what every power bond gives, takes, and gets from the coupling.

Both sides of a bond integrate its power inside their steps, with the inputs that they saw
(`models.core.bonds`). What arrives and was not sent has been created by the coupling.
"""

from .account import Account, lines
from .counting import Trimmed, counted, counting_structure
from .estimate import estimated
from .ledger import Ledger

__all__ = ["Account", "Ledger", "Trimmed", "counted", "counting_structure", "estimated", "lines"]

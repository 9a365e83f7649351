"""Energy ledger of a coupled run: energy sent, received and created by the coupling at each power bond.

Both sides of a bond integrate its power inside their steps, with the inputs that they had
(`models.core.bonds`). The coupling creates the difference of what arrives and what was sent.
"""

from .account import Account, lines
from .ledger import Ledger, add_counting, counting_structure

__all__ = ["Account", "Ledger", "add_counting", "counting_structure", "lines"]

"""Mistakes about a line contact: messages name the thing, its value, what is allowed and what to do."""

from .line_contact import LineContact

# The largest Moes' groups up to which films were found wherever they were tried.
TRIED_M, TRIED_L = 1000.0, 20.0


def likely_cause(contact: LineContact, film: float, nodes: int | None) -> str:
    """Why no film was found on `nodes` (None: any number), and what to do; `film` (m): the one expected."""
    if contact.M > TRIED_M or contact.L > TRIED_L:
        return f"the contact is outside the range of this solver, M <= {TRIED_M:g} and L <= {TRIED_L:g}"
    if contact.squeeze != 0.0:
        # The rate at which the entrained film crosses the contact; oil follows no gap that opens faster.
        carried = abs(contact.velocity) * film / contact.half_width
        return (
            f"squeeze = {contact.squeeze:g} m/s: must be well below velocity * film / half width = "
            f"{carried:.3g} m/s, or oil cannot follow the gap; reduce it, 0 is a steady film"
        )
    return "leave `nodes` out" if nodes else "change the load, the velocity or the asperities"

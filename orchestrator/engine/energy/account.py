"""What the ledger comes to at the end, for the summary and for the reader."""

from collections.abc import Iterator
from dataclasses import dataclass, field


@dataclass(frozen=True)
class BondAccount:
    """Energies (J) over one bond since the start.

    `given` left the side that gives the effort, `taken` arrived at the side that gives the flow, `created`
    is the difference; `largest_created` its largest size on the way, `relative` that over what was
    `exchanged` in either direction (0 where nothing was).
    """

    given: float = 0.0
    taken: float = 0.0
    created: float = 0.0
    largest_created: float = 0.0
    exchanged: float = 0.0
    relative: float = 0.0


@dataclass(frozen=True)
class ComponentAccount:
    """Energies (J) of one component since the start.

    stored (its change) + dissipated - sourced - received = outside_bonds = jumped + unaccounted.
    `jumped` came with inputs that jumped at communication points. `unaccounted` came within steps: from a
    position whose slope is not the velocity that was exchanged with it, from what the component's
    description of its energies leaves out, and from the error of the integration.
    """

    stored: float = 0.0
    dissipated: float = 0.0
    sourced: float = 0.0
    received: float = 0.0
    jumped: float = 0.0
    unaccounted: float = 0.0
    outside_bonds: float = 0.0


@dataclass
class Account:
    """The whole ledger up to the time `until` (s), its last record.

    What all components stored and dissipated less what sources and bonds to the outside gave is
    `created` + `outside_bonds`.
    """

    until: float = 0.0
    created: float = 0.0
    outside_bonds: float = 0.0
    bonds: dict[str, BondAccount] = field(default_factory=dict)
    components: dict[str, ComponentAccount] = field(default_factory=dict)
    not_counted: list[str] = field(default_factory=list)


def lines(account: Account) -> Iterator[str]:
    """What the reader should know, in sentences."""
    if account.bonds:
        name, worst = max(account.bonds.items(), key=lambda item: item[1].largest_created)
        yield (
            f"energy: over {name} the coupling created at most {worst.largest_created:.2g} J, "
            f"{worst.relative:.1e} of the {worst.exchanged:.4g} J exchanged there; over all bonds "
            f"{account.created:.2g} J until the end, outside bonds {account.outside_bonds:.2g} J"
        )
    else:
        yield "energy: no bond is counted on both of its sides"
    if account.not_counted:
        yield f"energy: not counted on both sides: {', '.join(account.not_counted)}"

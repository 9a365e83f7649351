"""Instances that count their energies."""

from collections.abc import Collection, Mapping
from dataclasses import replace

from models.core.bonds import counting
from models.core.system import System


def add_counting(system: System, names: Collection[str]) -> System:
    """The system with the instances `names` counting their energies."""
    return system.with_instances(
        {
            name: replace(i, component=counting(i.component)) if name in names else i
            for name, i in system.instances.items()
        }
    )


def counting_structure(structure: Mapping[str, int]) -> dict[str, int]:
    """The structure of the FMU that counts."""
    return {**structure, "energies": 1}

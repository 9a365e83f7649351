"""The energies of a component, counted inside its steps with the inputs that it really saw.

A component that counts its energies has more states and outputs: its stored energy, what that gained within
steps, the dissipated energy, the energy from internal sources, and the energy through each power bond. Inputs
that jump between two steps change the stored energy by more than `energy_gained`. Energy lost in impacts is
dissipated. Energy given by their impulses passes no bond and is not counted.

The powers are integrated along the motion's own steps (see `quadrature`). This does not affect the motion: it
has the same bits with and without.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property, wraps
from typing import Any

import numpy as np

from ..compile.kernel import kernel
from .component import DISSIPATED_POWER, IMPACT_LOSS, SOURCE_POWER, STORED, Component, Flat, PowerBond
from .integrator import OK, copy, taylor
from .quantities import Layout, Quantity

STORED_ENERGY = "energy_stored"
GAINED_ENERGY, DISSIPATED_ENERGY, SOURCED_ENERGY = "energy_gained", "energy_dissipated", "energy_sourced"
_COUNTED = {
    GAINED_ENERGY: "what the stored energy gained within steps",
    DISSIPATED_ENERGY: "energy lost inside the component since the start",
    SOURCED_ENERGY: "energy from sources inside the component since the start",
}
# Numbers that an energy kernel writes; powers before those of the bonds.
_ENERGIES, _INNER = 3, 2


def energy_through(bond: PowerBond) -> str:
    """The variable that counts what came in through the bond."""
    parts = (re.sub(r"\W+", "_", part).strip("_") for part in (bond.effort, bond.flow))
    return "energy_by_" + "_".join(parts)


def counts_energies(factory: Callable[..., Component]) -> Callable[..., Component]:
    """The factory with the option `energies=1`: its component then counts its energies."""

    @wraps(factory)
    def build(*sizes: Any, energies: int = 0, **named: Any) -> Component:
        component = factory(*sizes, **named)
        return counting(component) if energies else component

    return build


def counting(plain: Component) -> CountingComponent:
    """`plain` with its energies counted; ValueError if its equations are unknown."""
    if plain.opaque:
        raise ValueError(f"{plain.name}: its equations are unknown, by which energies are counted")
    counted = {name: Quantity("J", text) for name, text in _COUNTED.items()}
    for bond in plain.bonds:
        power = f"{'-' if bond.sign < 0 else ''}{bond.effort} * {bond.flow}"
        counted[energy_through(bond)] = Quantity("J", f"energy in by {power} since the start")
    stored = {STORED_ENERGY: Quantity("J", "energy stored in the component")}
    attributes: dict[str, Any] = {f.name: getattr(plain, f.name) for f in fields(Component)}
    attributes |= {
        "state": plain.state.extend(counted),
        "outputs": plain.outputs.extend(stored | counted),
        "feedthrough": {**plain.feedthrough, STORED_ENERGY: plain.inputs.names},
        "structure": {**plain.structure, "energies": 1},
    }
    return CountingComponent(**attributes, plain=plain)


@dataclass(frozen=True, eq=False)
class CountingComponent(Component):
    """`plain` with its energies: states and outputs are longer, the kernels run on their first part.

    The scratch vector has after the component's own: integrals, inputs, energies, powers, outputs.
    """

    plain: Component = None  # type: ignore[assignment]  # given always, after fields with defaults

    @property
    def kernel_state(self) -> Layout:
        """The states of `plain`, without the energies."""
        return self.plain.kernel_state

    @cached_property
    def flat(self) -> Flat:
        """Those of the component. The derivative is that of the motion: the energies change with steps, as
        counters do. The output has the energies after the component's own outputs."""
        plain, n, m = self.plain.flat, self.plain.state.size, self.plain.outputs.size
        derivative, output, energy = plain.derivative, plain.output, plain.energy

        @kernel
        def counting_derivative(t: float, x: Any, u: Any, p: Any, dx: Any) -> None:
            derivative(t, x[:n], u, p, dx[:n])
            dx[n:] = 0.0

        @kernel
        def counting_output(t: float, x: Any, u: Any, p: Any, y: Any) -> None:
            output(t, x[:n], u, p, y[:m])
            energy(t, x[:n], u, p, y[m : m + _ENERGIES])
            copy(y[m + 1 :], x[n:])

        def on_first(function: Any) -> Any:
            @kernel
            def evaluate(t: float, x: Any, u: Any, p: Any, result: Any) -> None:
                function(t, x[:n], u, p, result)

            return evaluate

        kernels = Flat(counting_derivative, counting_output, on_first(energy))
        if self.events is None:
            return kernels
        transition = plain.transition

        @kernel
        def counting_transition(k: int, t: float, x: Any, u: Any, p: Any) -> None:
            transition(k, t, x[:n], u, p)

        return replace(kernels, guards=on_first(plain.guards), transition=counting_transition)

    @cached_property
    def flat_rates(self) -> Any:
        """Those of the component. The stored energy of one that is no ODE changes by its powers: differences
        along its derivative would miss that."""
        rates = super().flat_rates
        if self.ode:
            return rates
        n, m, powers = self.plain.state.size, self.plain.outputs.size, _INNER + len(self.bonds)
        own_rates, find_powers = self.plain.flat_rates, make_powers(self.plain)

        @kernel
        def counting_rates(t: float, x: Any, u: Any, du: Any, p: Any, work: Any, yd: Any) -> None:
            own_rates(t, x[:n], u, du, p, work, yd[:m])
            y, e = work[:m], work[m : m + _ENERGIES]
            power = work[m + _ENERGIES : m + _ENERGIES + powers]
            find_powers(t, x[:n], u, p, y, e, power)
            yd[m:] = 0.0
            yd[m] = np.sum(power[1:]) - power[0]

        return counting_rates

    @cached_property
    def advance(self) -> Any:
        """That of the component, with the integrals beside it."""
        return self.with_integrals(self.sampled.advance)

    @cached_property
    def sampled(self) -> Component:
        """The component, which samples its powers."""
        extra = self.work_size - (self.plain.work_size - self.plain.extra_work)
        return replace(self.plain, sample=self._sample(), extra_work=extra)

    def with_integrals(self, advance: Any) -> Any:
        """`advance`, a kernel of `sampled`, with the integrals beside it."""
        plain, powers, energy = self.plain, _INNER + len(self.bonds), self.plain.flat_energy
        n, m, base = plain.state.size, plain.inputs.size, plain.work_size
        has_impacts = IMPACT_LOSS in plain.state
        loss = plain.state.index(IMPACT_LOSS) if has_impacts else 0

        @kernel
        def counting_advance(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any) -> int:
            room = work[base:]
            counted, u, e = (
                room[:powers],
                room[powers : powers + m],
                room[powers + m : powers + m + _ENERGIES],
            )
            counted[:] = 0.0
            taylor(U, 0.0, u)
            energy(t, x[:n], u, p, e)
            before, lost_before = e[STORED], x[loss]
            status = advance(t, h, x[:n], U, p, scale, work)
            if status == OK:
                taylor(U, h, u)
                energy(t + h, x[:n], u, p, e)
                x[n] += e[STORED] - before
                for i in range(powers):
                    x[n + 1 + i] += counted[i]
                if has_impacts:
                    x[n + DISSIPATED_POWER] += x[loss] - lost_before
            return status

        return counting_advance

    def _sample(self) -> Any:
        """sample(weight, t, s, x, U, u, p, work): adds to the integrals (see `quadrature`)."""
        plain, powers = self.plain, _INNER + len(self.bonds)
        m, base, find_powers = plain.inputs.size, plain.work_size, make_powers(plain)

        @kernel
        def sample(weight: float, t: float, s: float, x: Any, U: Any, u: Any, p: Any, work: Any) -> None:
            counted, room = work[base : base + powers], work[base + powers + m :]
            e, power, y = room[:_ENERGIES], room[_ENERGIES : _ENERGIES + powers], room[_ENERGIES + powers :]
            taylor(U, s, u)
            find_powers(t + s, x, u, p, y, e, power)
            for i in range(powers):
                counted[i] += weight * power[i]

        return sample

    @property
    def work_size(self) -> int:
        plain = self.plain
        own = 2 * (_INNER + len(plain.bonds)) + plain.inputs.size + _ENERGIES + plain.outputs.size
        return plain.work_size + own


def make_powers(component: Component) -> Any:
    """powers(t, x, u, p, y, e, power): dissipated and source power, then those of the bonds (W).

    y and e are room for outputs and energies; y may be longer.
    """
    output, energy, m = component.flat_output, component.flat_energy, component.outputs.size
    # Variables are numbered through inputs, then outputs.
    inputs, names = component.inputs.size, (*component.inputs.names, *component.outputs.names)
    efforts = tuple(names.index(bond.effort) for bond in component.bonds)
    flows = tuple(names.index(bond.flow) for bond in component.bonds)
    signs = tuple(float(bond.sign) for bond in component.bonds)
    count = len(signs)
    if not count:  # compiled code cannot index an empty tuple
        efforts, flows, signs = (0,), (0,), (0.0,)

    @kernel
    def find_powers(t: float, x: Any, u: Any, p: Any, y: Any, e: Any, power: Any) -> None:
        output(t, x, u, p, y[:m])
        energy(t, x, u, p, e)
        power[0] = e[DISSIPATED_POWER]
        power[1] = e[SOURCE_POWER]
        for i in range(count):
            effort = u[efforts[i]] if efforts[i] < inputs else y[efforts[i] - inputs]
            flow = u[flows[i]] if flows[i] < inputs else y[flows[i] - inputs]
            power[_INNER + i] = signs[i] * effort * flow

    return find_powers

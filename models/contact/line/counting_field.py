"""The contact with a pressure field that counts its energies: `energies` along its steps, as in `bonds`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...core.bonds import STORED_ENERGY, CountingComponent, counting, make_powers
from ...core.integrator import OK, taylor
from ...core.quantities import Vector
from .field import LINE_TRANSIENT, FieldContact, make_field_start


@dataclass(frozen=True, eq=False)
class CountingField(CountingComponent):
    """`plain`, a FieldContact, with its energies.

    As there, what the parameters ask for is chosen in Python: the field's steps, or those of the formula.
    """

    plain: FieldContact = None  # type: ignore[assignment]  # given always, after fields with defaults

    @cached_property
    def advance(self) -> Any:
        """As `Component.advance`."""
        n, fielded, film_model = self.plain.plain.state.size, self.plain.state.size, self._film_model

        def advance(t: float, h: float, x: Vector, U: Vector, p: Vector, scale: Vector, work: Vector) -> int:
            if p[film_model] == LINE_TRANSIENT:
                return self._solve(t, h, x, U, p, scale, work)
            state = self._without_field(x)
            status = int(self._formula.advance(t, h, state, U, p, self._without_field(scale), work))
            x[:n], x[fielded:] = state[:n], state[n:]
            return status

        return advance

    def _solve(self, t: float, h: float, x: Vector, U: Vector, p: Vector, scale: Vector, work: Vector) -> int:
        """A step of the field."""
        before = x.copy()
        if h > 0.0:
            self._start(x[: self.plain.state.size], U, p, work)
        status = int(self._solving(t, h, x, U, p, scale, work))
        if status != OK:
            x[:] = before
        return status

    @cached_property
    def step(self) -> Any:
        """As `Component.step`."""

        def step(
            t: float,
            h: float,
            x: Vector,
            U: Vector,
            p: Vector,
            scale: Vector,
            work: Vector,
            u: Vector,
            y: Vector,
        ) -> int:
            status = int(self.advance(t, h, x, U, p, scale, work))
            taylor(U, h, u)
            self.flat_output(t + h, x, u, p, y)
            return status

        return step

    @cached_property
    def flat_rates(self) -> Any:
        """As `Component.flat_rates`: those of `plain`, and that of the energy stored by the powers.

        No difference of outputs would show it: a field's state has no rates.
        """
        n, m, stored = self.plain.state.size, self.plain.outputs.size, self.outputs.index(STORED_ENERGY)
        powers, formula = make_powers(self.plain), self._formula.flat_rates
        power, e, y = np.zeros(2 + len(self.bonds)), np.zeros(3), np.zeros(m)

        def flat_rates(
            t: float, x: Vector, u: Vector, du: Vector, p: Vector, work: Vector, yd: Vector
        ) -> None:
            if p[self._film_model] != LINE_TRANSIENT:
                formula(t, self._without_field(x), u, du, p, work, yd)
                return
            self.plain.flat_rates(t, x[:n], u, du, p, work, yd[:m])
            powers(t, x[:n], u, p, y, e, power)
            yd[m:] = 0.0
            dissipated, given = power[0], power[1:]
            yd[stored] = given.sum() - dissipated

        return flat_rates

    @cached_property
    def _formula(self) -> CountingComponent:
        return counting(self.plain.plain)

    def _without_field(self, state: Vector) -> Vector:
        """What `_formula` has of it."""
        return np.concatenate((state[: self.plain.plain.state.size], state[self.plain.state.size :]))

    @property
    def _film_model(self) -> int:
        return self.parameters.index("film_model")

    @cached_property
    def _solving(self) -> Any:
        return self.with_integrals(self.sampled.solving)  # type: ignore[attr-defined]

    @cached_property
    def _start(self) -> Any:
        return make_field_start(self.plain)

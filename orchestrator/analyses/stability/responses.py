"""Linearisation of any participant by its responses to pulses, which a linear system is fitted to.

The realisation is the smallest system with these responses (Ho and Kalman 1966, with the singular values of
Kung 1978, "ERA").
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import logm, schur

from models.core.quantities import Vector
from models.core.system import ModelError, System
from models.monolithic.trajectory import Trajectory

from ...errors import EndedError, RecoverableError
from ...participants.protocol import Participant
from .linear import ROWS, Linear
from .trajectory import NotLinearError, ParticipantLinearisation

# Samples of a response.
SAMPLES = 60
# Sizes of pulses, in nominal sizes of the input, the largest first: far above the integration error. The
# first whose responses to both signs agree up to EVEN is taken: a central difference then errs by the square
# of that. At a kink, where none agree up to KINK, the larger response is taken.
SHARES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
EVEN, KINK = 1e-3, 1e-2
# Responses below this share of an output's nominal size are ignored.
SILENT = 1e-13
# Effects of a Taylor coefficient below this, in nominal sizes, are lost in integration errors.
FAINT = 1e-10
# How a participant comes back to an instant, in words.
SAVED, FRESH = "saved and restored states", "fresh instances brought to the same instants"
# Residuals above which the report warns, and above which the instant is left out.
DOUBTFUL, USELESS = 1e-2, 0.5


class Responses(ParticipantLinearisation):
    """Of a participant that can save and restore its state, or `returns` to it
    otherwise.

    At an instant of the trajectory its inputs are held, and each gets a pulse of one sample, up and down.
    A linear system is fitted to the change of its outputs over SAMPLES samples of `spacing` seconds.
    """

    def __init__(
        self, name: str, participant: Participant, system: System, spacing: float, returns: str = SAVED
    ) -> None:
        super().__init__(name, participant, system)
        self._returns = returns
        component = system.instances[name].component
        self._spacing, self._beyond = spacing, SAMPLES * spacing
        self._instead = ""
        if component.ode:
            self._instead = ", or analyse the component in its place (participant = 'in-process')"
        whole = [component.inputs.field(n).quantity.discrete for n in self.input_names]
        self._perturbed = np.flatnonzero(~np.array(whole, dtype=bool))
        self._opaque = component.opaque
        self._sizes = self._layouts[0].nominal[self._columns]
        self.residuals: dict[float, float] = {}
        self._ended = ""  # why it can't be stepped any more

    def about(self, trajectory: Trajectory, row: int, outputs: Collection[str]) -> Linear:
        if not self.input_names:  # nothing moves it
            nothing = np.zeros((len(self._rows), 0))
            linear = Linear(np.zeros((0, 0)), np.zeros((0, 0)), nothing, nothing, np.zeros(0))
            return self._expand(linear, np.ones((ROWS, 0)), [], outputs)
        try:
            if not self._ended:
                return self._linearise(trajectory, row, outputs)
        except EndedError as error:
            self._ended = (
                f"{self.name}: the FMU ends the simulation at t = {error.reached:.6g} s, before its "
                f"responses from t = {trajectory.times[row]:.6g} s on are over ({self._beyond:.3g} s, "
                f"{SAMPLES} macro steps)"
            )
        raise NotLinearError(self._ended)

    def _linearise(self, trajectory: Trajectory, row: int, outputs: Collection[str]) -> Linear:
        self._advance_to(trajectory, row)
        if self._opaque:  # whose nominal sizes are often 1 for want of better
            spans = np.ptp(self._values, axis=0)
            self._sizes = np.where(spans > 0.0, spans, self._layouts[0].nominal[self._columns])
        t = float(trajectory.times[row])
        held = trajectory.inputs[row][self._slots][self._columns]
        saved = self._participant.save()
        try:
            found, kinks = self._realise(t, held, saved)
            followed = self._find_followed(t, held, saved, found.linear)
            self._participant.restore(saved)
        finally:
            self._participant.release(saved)
        if found.residual > USELESS:
            raise NotLinearError(
                f"{self.name}: its responses at t = {t:.6g} s are not those of a linear system (residual "
                f"{found.residual:.0%}); shorten macro_step, their sampling interval{self._instead}"
            )
        self.residuals[t] = found.residual
        return self._expand(found.linear, followed, kinks, outputs)

    def _respond(self, t: float, held: Vector, pulse: Vector, saved: object) -> Vector:
        """Outputs at once and after each sample, (1 + SAMPLES) x outputs."""
        unit, inputs, h = self._participant, self._inputs, self._spacing
        found = np.empty((1 + SAMPLES, len(self._outputs)))
        unit.restore(saved)
        inputs[:] = 0.0
        inputs[0] = held + pulse
        unit.write()
        unit.read()
        found[0] = self._outputs
        for k in range(SAMPLES):
            unit.advance(t + k * h, h)
            unit.read()
            found[1 + k] = self._outputs
            if k == 0:
                inputs[0] = held
                unit.write()
        return found

    def _realise(self, t: float, held: Vector, saved: object) -> tuple[Realisation, list[str]]:
        rest = self._respond(t, held, np.zeros_like(held), saved)
        answers = np.zeros((*rest.shape, len(self.input_names)))
        noise = np.zeros((len(self._rows), len(self.input_names)))
        kinks = []
        for j in self._perturbed:
            answers[:, :, j], even, pulse = self._measure_response(t, held, saved, rest, int(j))
            noise[:, j] = SILENT * self._layouts[1].nominal[self._rows] / pulse
            if even > KINK:
                kinks.append(self.input_names[j])
        return realise(answers[1:], answers[0], self._spacing, self._sizes, noise), kinks

    def _measure_response(
        self, t: float, held: Vector, saved: object, rest: Vector, j: int
    ) -> tuple[Vector, float, float]:
        """The response to a pulse in input j over its size; how much both signs differ; the pulse's size."""
        nominal = self._sizes[j]
        size = self._layouts[1].nominal[self._rows]
        best: tuple[float, Vector, float] | None = None
        failed: RecoverableError | None = None
        for share in SHARES:
            pulse = np.zeros_like(held)
            pulse[j] = share * nominal
            try:
                up = (self._respond(t, held, pulse, saved) - rest) / pulse[j]
                down = (rest - self._respond(t, held, -pulse, saved)) / pulse[j]
            except RecoverableError as error:
                failed = error
                continue
            odd, even = np.max(np.abs(up + down), axis=0) / 2.0, np.max(np.abs(up - down), axis=0) / 2.0
            heard = odd * pulse[j] > SILENT * size
            uneven = float(np.max(even[heard] / odd[heard], initial=0.0))
            if not np.isfinite(uneven + odd.sum()):
                continue
            steeper = max(up, down, key=lambda side: float(np.max(np.abs(side) / size)))
            # At a kink the smallest pulse is nearest to it.
            if best is None or uneven < best[0] or min(uneven, best[0]) > KINK:
                best = uneven, steeper if uneven > KINK else 0.5 * (up + down), float(pulse[j])
            if uneven <= EVEN:
                break
        if best is None:
            said = f": {failed}" if failed else ""
            raise ModelError(
                f"{self.name}: no answer to small changes of {self.input_names[j]} at t = {t:.6g} s{said}; "
                f"shorten macro_step, the sampling interval{self._instead}"
            )
        return best[1], best[0], best[2]

    def _find_followed(self, t: float, held: Vector, saved: object, linear: Linear) -> Vector:
        """Find the Taylor coefficients of its inputs to which it responds as the linear system does."""
        unit, h = self._participant, self._spacing
        followed = np.ones((ROWS, len(self.input_names)))
        degrees = np.array(unit.signal_degrees(self.input_names), dtype=int)
        followed[1:, degrees == 0] = 0.0
        rest = self._respond(t, held, np.zeros_like(held), saved)[1]
        _, gamma, ends = linear.step(h)
        effect = linear.C @ gamma + linear.D @ ends[: len(self.input_names)]
        size = self._layouts[1].nominal[self._rows]
        for k in range(1, ROWS - 1):
            for j in self._perturbed[degrees[self._perturbed] > 0]:
                # The value at the end changes by a small share.
                amount = SHARES[2] * self._sizes[j] * math.factorial(k) / h**k
                expected = effect[:, k * len(self.input_names) + j] * amount / size
                if np.linalg.norm(expected) < FAINT:
                    continue
                unit.restore(saved)
                self._inputs[:] = 0.0
                self._inputs[0] = held
                self._inputs[k, j] = amount
                unit.write()
                unit.advance(t, h)
                unit.read()
                seen = (self._outputs - rest) / size
                if np.linalg.norm(seen - expected) > np.linalg.norm(seen):
                    followed[k, j] = 0.0
        return followed

    @property
    def residual(self) -> float:
        """The largest residual so far."""
        return max(self.residuals.values(), default=0.0)

    @property
    def description(self) -> tuple[str, str]:
        how = f"By responses to pulses, from {self._returns}"
        return how, f"{self.name} (residual {self.residual:.1g})"

    def describe_doubts(self) -> Iterator[str]:
        """Sentences about large residuals and held inputs."""
        yield from super().describe_doubts()
        t, worst = max(self.residuals.items(), key=lambda item: item[1], default=(0.0, 0.0))
        if worst > DOUBTFUL:
            yield (
                f"{self.name}: the linear system fits its responses at t = {t:.4g} s to {worst:.0%} only; "
                "take limits and errors with care, or sample it more finely (macro_step)."
            )


# Singular values below this share of the largest are rounding errors.
ROUNDING = 1e-11
MOST_STATES = 24
# States are not added if the residual is below FINE, or within the factor NEARLY of the best.
FINE, NEARLY = 1e-6, 10.0
# Other candidates to try if the preferred one has no continuous-time form.
OTHERS = 5
# Weights: responses below QUIET times the noise count less, and decayed responses count as BRIEF of the
# largest.
QUIET, BRIEF = 1e4, 0.05
# Discrete eigenvalues below this belong to modes that decay within a sample; they are set to it.
GONE = 1e-5


# (phi, gamma, observed): x+ = phi x + gamma u, y = observed x.
DiscreteSystem = tuple[Vector, Vector, Vector]


@dataclass(frozen=True)
class Realisation:
    """A linear system and its residual: RMS of the difference between its responses and those given, over the
    RMS of the responses or over BRIEF of the largest if that is more; the largest of all outputs."""

    linear: Linear
    residual: float


def realise(pulses: Vector, direct: Vector, spacing: float, given: Vector, noise: Vector) -> Realisation:
    """Fit a linear system to the responses `pulses` (samples x outputs x inputs) to unit pulses of one
    sample.

    Samples are `spacing` seconds apart; `direct` (outputs x inputs) are the responses at once. `given` are
    the sizes that weight the inputs. Outputs are weighted by their largest response, or by `noise` if that is
    near.
    """
    p, m = direct.shape
    nothing = Linear(np.zeros((0, 0)), np.zeros((0, m)), np.zeros((p, 0)), direct, np.zeros(0))
    if not direct.size:
        return Realisation(nothing, 0.0)
    moved = pulses.copy()
    moved[0] -= direct
    weight = np.maximum(np.max(np.abs(moved * given), axis=(0, 2)), QUIET * np.max(noise * given, axis=1))
    scaled = moved * given / weight[:, None]
    strength = np.max(np.abs(scaled), axis=(0, 1))
    # Inputs with responses in the noise have no effect.
    scaled[:, :, strength < 1.0 / QUIET] = 0.0
    strength[strength < 1.0 / QUIET] = 1.0
    scaled /= strength
    if not np.any(np.abs(scaled) > 1.0 / QUIET):
        return Realisation(nothing, 0.0)
    best: Realisation | None = None
    for phi, gamma, observed in _rank_candidates(scaled):
        try:
            A, B = to_continuous(phi, gamma, spacing)
        except (ValueError, np.linalg.LinAlgError):
            continue
        own = Linear(A, B, observed, np.zeros((p, m)), np.ones(len(A)))
        again, effect, _ = own.step(spacing)
        residual = _compute_residual((again, effect[:, :m], observed), scaled)
        if best is None or residual < best.residual:
            linear = Linear(A, B * strength / given, observed * weight[:, None], direct, np.ones(len(A)))
            best = Realisation(linear, residual)
        if residual <= NEARLY * max(FINE, _compute_residual((phi, gamma, observed), scaled)):
            break
    assert best is not None
    return best


def _rank_candidates(scaled: Vector) -> list[DiscreteSystem]:
    """Rank realisations: first the smallest that is FINE or NEARLY as good as the best, then by residual."""
    found = []
    for candidate in _generate_candidates(scaled):
        found.append((_compute_residual(candidate, scaled), candidate))
        if found[-1][0] <= FINE:
            break
    enough = max(FINE, NEARLY * min(residual for residual, _ in found))
    smallest = next(i for i, (residual, _) in enumerate(found) if residual <= enough)
    rest = sorted(found[:smallest] + found[smallest + 1 :], key=lambda item: item[0])
    return [found[smallest][1], *(candidate for _, candidate in rest[:OTHERS])]


def _generate_candidates(scaled: Vector) -> Iterator[DiscreteSystem]:
    """Generate realisations of increasing order."""
    n, p, m = scaled.shape
    rows = n // 2

    def hankel(first: int) -> Vector:
        return np.block([[scaled[first + i + j] for j in range(n - rows)] for i in range(rows)])

    left, sizes, right = np.linalg.svd(hankel(0))
    shifted = hankel(1)
    for order in range(1, min(MOST_STATES, int(np.sum(sizes > ROUNDING * sizes[0]))) + 1):
        root = np.sqrt(sizes[:order])
        observed, reached = left[:, :order] * root, right[:order].T * root
        phi = (left[:, :order] / root).T @ shifted @ (right[:order].T / root)
        yield phi, reached[:m].T, observed[:p]


def to_continuous(phi: Vector, gamma: Vector, spacing: float) -> tuple[Vector, Vector]:
    """Find (A, B) of x' = A x + B u that is x+ = phi x + gamma u when sampled with held inputs."""
    upper, vectors = schur(phi, output="complex")
    own = np.diagonal(upper).copy()
    # The logarithm needs eigenvalues other than zero; GONE stands for modes that decay at once.
    over = np.abs(own) < GONE
    own[over] = GONE
    np.fill_diagonal(upper, own)
    lasting = (vectors @ upper @ vectors.conj().T).real
    n, m = gamma.shape
    whole = np.zeros((n + m, n + m))
    whole[:n, :n], whole[:n, n:] = lasting, gamma
    whole[n:, n:] = np.eye(m)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the residual decides
        found = np.asarray(logm(whole)).real / spacing
    if not np.all(np.isfinite(found)):
        raise np.linalg.LinAlgError("no logarithm")
    return found[:n, :n], found[:n, n:]


def _compute_residual(system: DiscreteSystem, scaled: Vector) -> float:
    """The residual; infinite if it is not finite."""
    phi, state, observed = system
    difference = np.empty_like(scaled)
    with np.errstate(over="ignore", invalid="ignore"):
        for k, sample in enumerate(scaled):
            difference[k] = observed @ state - sample
            state = phi @ state
        mean = np.sqrt(np.mean(scaled**2, axis=(0, 2)))
        residual = np.sqrt(np.mean(difference**2, axis=(0, 2)))
    worst = float(np.max(residual / np.maximum(mean, BRIEF)))
    return worst if np.isfinite(worst) else np.inf

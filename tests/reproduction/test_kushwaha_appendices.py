"""Appendices 1 to 3 of Kushwaha et al. 2000: each line by another way than the judgement's."""

import numpy as np
import pytest
import sympy

from reproduction.kushwaha2000 import appendices
from reproduction.kushwaha2000.runs import Runs


@pytest.fixture(scope="module")
def runs() -> Runs:
    return Runs()


def test_the_printed_rotation_turns_as_three_turns_do() -> None:
    """Against sympy's rotation matrices, element by element."""
    psi, theta, phi = angles = sympy.symbols("psi theta phi")
    # sympy turns axes, the paper vectors.
    whole = sympy.rot_axis3(-psi) * sympy.rot_axis1(-theta) * sympy.rot_axis3(-phi)
    for sample in appendices.SAMPLES:
        expected = np.array(whole.subs(dict(zip(angles, sample, strict=True))), float)
        np.testing.assert_allclose(appendices.print_rotation(*sample), expected, atol=1e-15)


def test_inertia_is_the_kinetic_energys_second_derivative(runs: Runs) -> None:
    """K = omega I omega/2 with omega from the rotation's rate, R' = skew(omega) R, by complex steps."""
    own, sample = np.array([0.1, 0.2, 0.25]), appendices.SAMPLES[0]
    columns = []
    for k in range(3):
        moved = [a + (1e-30j if i == k else 0.0) for i, a in enumerate(sample)]
        rate = np.imag(appendices.rotate(*moved)) / 1e-30 @ np.real(appendices.rotate(*sample)).T
        columns.append([rate[2, 1], rate[0, 2], rate[1, 0]])
    lever, rotation = np.array(columns).T, np.real(appendices.rotate(*sample))
    expected = lever.T @ rotation @ np.diag(own) @ rotation.T @ lever
    np.testing.assert_allclose(appendices.find_inertia(own, *sample), expected, atol=1e-15)
    assert appendices.check_inertia(runs)["wrong"] == ["c1", "c3"]


def test_gradients_are_central_differences_of_the_constraints(runs: Runs) -> None:
    q = appendices.place_parts(appendices.SAMPLES[0], appendices.SAMPLES[1])
    found, functions = appendices.differentiate(runs, q), appendices.make_rise(runs)
    for name in q:
        ahead, behind = (appendices.constrain({**q, name: q[name] + h}, *functions) for h in (1e-6, -1e-6))
        for constraint in ahead:
            slope = (ahead[constraint] - behind[constraint]) / 2e-6
            assert found.get(constraint, {}).get(name, 0.0) == pytest.approx(slope, abs=1e-9)


def test_one_sign_is_wrong_and_five_entries_are_missing_in_appendix_3(runs: Runs) -> None:
    found = appendices.check_gradients(runs)
    assert (found["printed"], found["right"]) == (25, 24)
    assert found["wrong"] == ["∂C4/∂φ1"]
    assert found["missing"] == ["∂C1/∂ψ1", "∂C10/∂ψ2", "∂C11/∂ψ2", "∂C12/∂ψ1", "∂C2/∂ψ1"]
    assert appendices.find_ranks(runs) == {"bearing": 3, "guide": 4}

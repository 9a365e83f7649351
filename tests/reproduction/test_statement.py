"""Tables of statements: how a claim is judged, and how its texts are written."""

import pytest

from reproduction.statement import Claim, Numbers, Verdict, format_numbers, state_verdict


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("{loads:.1f} N", "330.0, 610.2 N"),
        ("{film:µ.2f} µm", "1.30 µm"),
        ("{pressure:G.2f} GPa", "0.47 GPa"),
        ("{share:.0f%}", "12 %"),
        ("{angles:+.1f°}", "-36.0°, +36.0°"),
        ("{loads[1]:.0f}; {words}", "610; none"),
    ],
)
def test_numbers_are_written_with_their_units(text: str, written: str) -> None:
    numbers = Numbers({
        "loads": [330.0, 610.2], "film": 1.3e-6, "pressure": 4.7e8, "share": 0.12, "angles": [-36.0, 36.0],
        "words": "none",
    })  # fmt: skip
    assert format_numbers(text, numbers) == written


@pytest.mark.parametrize(("stated", "verdict"), [(2.0, Verdict.MET), (3.0, Verdict.NOT_MET)])
def test_a_claim_is_judged_by_its_criterion(stated: float, verdict: Verdict) -> None:
    claim = Claim[float]("key", "2.1", "twice", lambda runs: {"twice": 2.0 * runs, "unread": 1.0},
                         "{twice:g}", lambda v: v.twice == stated)  # fmt: skip
    found = claim.judge(1.0)
    assert (found.computed, found.verdict, found.values) == ("2", verdict, {"twice": 2.0})


def test_a_missing_number_is_an_error() -> None:
    claim = state_verdict("key", "2.1", "text", "{absent}", Verdict.CANNOT)
    with pytest.raises(KeyError, match="absent"):
        claim.judge(1.0)

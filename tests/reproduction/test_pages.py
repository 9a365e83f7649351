"""Pages of reproductions are current; claims are judged and written as their tables say."""

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reproduction import SOURCES, load_publication
from reproduction.__main__ import app
from reproduction.publication import JSON
from reproduction.statement import Claim, Numbers, Verdict, format_numbers, state_verdict

DOCS = Path(__file__).parents[2] / "docs"
# A larger figure does not belong into a repository.
LARGEST_FIGURE_BYTES = {
    "farahanchi1991": 60_000,
    "films": 150_000,
    "kushwaha2000": 150_000,
    "qin2000": 150_000,
}
NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def page(source: str) -> str:
    return (DOCS / load_publication(source).page_name).read_text("utf-8")


def table_rows(text: str) -> list[list[str]]:
    """The cells of the statements' rows."""
    lines = [line for line in text.splitlines() if line.startswith("| ") and "**" in line]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]


@pytest.mark.parametrize("source", SOURCES)
def test_the_page_has_every_statement_and_small_figures(source: str) -> None:
    text, found = page(source), load_publication(source)
    assert found.introduction in text
    places = [row[0] for row in table_rows(text)]
    assert places == [claim.place for claim in found.claims]
    assert len({claim.key for claim in found.claims}) == len(found.claims)
    drawn = re.findall(r"\((figures/[^)]+)\)", text)
    assert {Path(figure).name for figure in drawn} <= {figure.file for figure in found.figures}
    for figure in drawn:
        assert 10_000 < (DOCS / figure).stat().st_size < LARGEST_FIGURE_BYTES[source]


@pytest.mark.long
@pytest.mark.parametrize("source", SOURCES)
def test_the_page_is_current(source: str, tmp_path: Path) -> None:
    found, out = load_publication(source), tmp_path / "out"
    done = CliRunner().invoke(app, [source, "--out", str(out)])
    assert done.exit_code == 0, done.output
    assert {path.name for path in (out / "figures").iterdir()} == {figure.file for figure in found.figures}
    assert len(json.loads((out / JSON).read_text("utf-8"))) == len(found.claims)
    made, kept = table_rows((out / found.page_name).read_text("utf-8")), table_rows(page(source))
    assert len(made) == len(kept)
    for one, other in zip(made, kept, strict=True):
        # Place, statement and verdicts. Numbers of chaotic motions change with rounding.
        same = [cell for cell in one if cell.startswith("**")] + one[:2]
        assert same == [cell for cell in other if cell.startswith("**")] + other[:2], "regenerate the page"
        if source in ("kushwaha2000", "qin2000"):
            pairs = zip(NUMBER.findall(" ".join(one)), NUMBER.findall(" ".join(other)), strict=True)
            # Differences that rounding leaves (about 1e-15) carry no meaning.
            assert all(float(a) == pytest.approx(float(b), rel=0.03, abs=0.011) for a, b in pairs), one


@pytest.mark.parametrize("held", [JSON, "figures/kushwaha2000-fig2.png"])
def test_a_result_is_not_overwritten(held: str, tmp_path: Path) -> None:
    (tmp_path / held).parent.mkdir(exist_ok=True)
    (tmp_path / held).write_text("kept")
    refused = CliRunner().invoke(app, ["kushwaha2000", "--out", str(tmp_path)])
    assert refused.exit_code == 2
    assert held in refused.output.replace("\n", "")
    assert "--overwrite" in refused.output
    assert (tmp_path / held).read_text() == "kept"


def test_an_unknown_source_is_refused() -> None:
    unknown = CliRunner().invoke(app, ["kushwaha200"])
    assert unknown.exit_code == 2
    assert "did you mean kushwaha2000?" in unknown.output


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

"""The reference of scenario files has every key and choice, and the examples of the documents are read."""

import math
import re
import shlex
import shutil
import subprocess
import sys
import textwrap
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from fmus.build import build
from models.contact.films.groups import Conditions
from models.core.quantities import Quantity
from orchestrator.masters.acceleration import ACCELERATIONS
from orchestrator.plots.data import FigureData
from orchestrator.scenario.files import list_shipped, load
from orchestrator.scenario.schema import build_schema
from orchestrator.stepping.estimators import ESTIMATORS

from .orchestrator.commands import called
from .orchestrator.coupled import run_coupled
from .orchestrator.two_masses import exact, two_masses

DOCS = Path(__file__).parent.parent / "docs"

PAGE = (DOCS / "reference" / "scenarios.md").read_text(encoding="utf-8")
CODE = re.findall(r"```\w*\n(.+?)```|`([^`\n]+)`", PAGE, re.DOTALL)
PAGES = (
    "tutorials/first-valve-train", "how-to/build-a-valve-train", "how-to/use-your-own-cam",
    "how-to/write-a-scenario", "how-to/choose-a-film", "how-to/film-friction-wear", "how-to/choose-an-oil",
    "reference/scenarios",
)  # fmt: skip
EXAMPLES = [
    example
    for page in PAGES
    for example in re.findall(r"```toml\n(.+?)```", (DOCS / f"{page}.md").read_text("utf-8"), re.DOTALL)
]


def test_every_key_of_the_schema_and_every_choice_is_in_the_reference() -> None:
    """Otherwise: add these words, as code, to docs/reference/scenarios.md."""
    content = build_schema()
    tables = [d["properties"] for name, d in content["$defs"].items() if name.endswith("Table")]
    assert len(tables) == 5
    keys = {key for table in [content["properties"], *tables] for key in table}
    masters = content["$defs"]["MasterTable"]["properties"]["name"]["anyOf"][0]["enum"]
    words = set(re.findall(r"\w+", " ".join("".join(found) for found in CODE)))
    assert sorted({*keys, *masters, *ACCELERATIONS, *ESTIMATORS} - words) == []


@pytest.mark.long
def test_the_survey_in_the_guide_to_masters_is_the_one_that_is_printed(tmp_path: Path) -> None:
    page = (DOCS / "how-to" / "choose-master-and-step.md").read_text("utf-8")
    shown = " ".join(page.partition("every signal:\n\n```\n")[2].partition("```")[0].split())
    printed = called("analyse", "valve-train", "--out", str(tmp_path / "survey")).stdout
    said = " ".join(printed.replace("─", "").split())
    for part in shown.replace("─", "").split("..."):
        assert " ".join(part.split()) in said


@pytest.mark.parametrize("example", EXAMPLES)
def test_every_example_is_read(example: str, tmp_path: Path) -> None:
    file = tmp_path / "example.toml"
    # The files that examples name.
    shutil.copy(list_shipped()["my-cam"].with_suffix(".csv"), tmp_path)
    pressure = "angle [deg], pressure [bar]\n0, 60\n180, 2\n360, 1\n540, 1\n720, 60\n"
    (tmp_path / "pressure.csv").write_text(pressure)
    whole = re.search("^(extends|stop_time) = ", example, re.MULTILINE)
    file.write_text(example if whole else f'extends = "valve-train"\n{example}', encoding="utf-8")
    load(file)


def test_the_example_with_a_third_party_fmu_is_a_whole_scenario(tmp_path: Path) -> None:
    """With any FMU in its place, whose parameters are others."""
    page = (DOCS / "how-to" / "third-party-fmus.md").read_text("utf-8")
    (example,) = re.findall(r"```\n([^`]*VanDerPol.fmu.+?)```", page, re.DOTALL)
    fmu = build("falling_mass")
    lines = [line for line in example.splitlines() if not line.startswith(("parameters", "start = {"))]
    file = tmp_path / "example.toml"
    file.write_text("\n".join(lines).replace("VanDerPol.fmu", str(fmu)), encoding="utf-8")
    assert load(file).stop_time == 20.0


EXTENDING = (DOCS / "how-to" / "extending.md").read_text(encoding="utf-8")


def test_the_files_named_for_extensions_exist() -> None:
    root = Path(__file__).parent.parent
    rooms = ("models", "fmus", "orchestrator", "interop", "tests")
    named = re.findall(r"`([\w/]+/[\w.]*)`", EXTENDING)
    recipes = "NAME", "sprung_tappet"
    paths = [
        path for path in named if path.split("/")[0] in rooms and not any(new in path for new in recipes)
    ]
    assert len(paths) > 10
    assert [path for path in paths if not (root / path).exists()] == []


def run_example(word: str, package: str) -> dict[str, Any]:
    """The names of the example with that word, run as a module of the package."""
    examples = re.findall(r"```python\n(.+?)\n *```", EXTENDING, re.DOTALL)
    (example,) = (textwrap.dedent(text) for text in examples if word in text)
    module = ModuleType(f"{package}.example")
    module.__dict__["__package__"] = package
    sys.modules[module.__name__] = module  # where dataclass looks for annotations
    exec(compile(example, module.__name__, "exec"), module.__dict__)
    return module.__dict__


def carry_out(recipe: str, root: Path) -> list[str]:
    """Write and change the files that the recipe names, in this copy of the packages; these files."""
    written = re.findall(r"Write [^`]*`([^`]+)`.+?```\w+\n(.+?)\n *```", recipe, re.DOTALL)
    for path, text in written:
        (root / path).parent.mkdir(exist_ok=True)
        (root / path).write_text(textwrap.dedent(text) + "\n", encoding="utf-8")
    changes = re.findall(r"[Ii]n\s+`([^`]+)` add [^`]+ to `(\w+)`:\s+`([^`]+)`", recipe)
    for changed, place, line in changes:
        content = (root / changed).read_text("utf-8")
        (root / changed).write_text(content.replace(f"{place} = {{", f"{place} = {{\n    {line},"), "utf-8")
    return [*(path for path, _ in written), *(changed for changed, _, _ in changes)]


# The tappet's acceleration less k y / m, as anything else would change more; and its drawing.
SPRUNG = """
from models.catalogue import CATALOGUE
from orchestrator.report.mechanism import list_sketches
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

found = []
for name in ("tappet", "sprung_tappet"):
    component = CATALOGUE[name]()
    p, x = component.parameters.vector({}), component.state.vector({"position": 4e-3})
    dx = x * 0.0
    component.flat_derivative(0.0, x, component.inputs.vector({}), p, dx)
    found.append(dx[1])
    mass = component.parameters.named(p)["mass"]
assert abs(found[1] - found[0] + 2e3 * 4e-3 / mass) < 1e-12 * abs(found[1]), found
scenario = load("pushrod-train", [f"components.tappet.{key}" for key in (
    "component=sprung_tappet", "participant=in-process", "parameters.return_stiffness='5 N/mm'")])
(sketch,) = list_sketches(scenario, build_system(scenario).outputs.names)
assert "tappet" in str(sketch.content())
"""


def test_the_recipe_of_a_mechanism_makes_a_follower_in_five_files(tmp_path: Path) -> None:
    """In a copy of the packages: its law, its drawing, and the commands of the recipe for its FMU."""
    recipe = EXTENDING.split("\n## A mechanism\n")[1].split("\n## ")[0]
    root = Path(__file__).parent.parent
    for package in ("models", "fmus", "orchestrator", "tribocosim"):
        shutil.copytree(root / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    files = carry_out(recipe, tmp_path)
    assert len(files) == 4  # and the row of its tolerances
    (commands,) = re.findall(r"```sh\n(.+?)```", recipe, re.DOTALL)
    called = [["-m", *shlex.split(command)] for command in commands.splitlines()]
    assert len(called) == 3
    for words in (["-c", SPRUNG], *called):
        done = subprocess.run(
            [sys.executable, *words], cwd=tmp_path, capture_output=True, text=True, timeout=280
        )
        assert done.returncode == 0, done.stdout + done.stderr


def test_the_example_of_a_film_has_the_exponents_that_it_states() -> None:
    film = run_example("def film(", "models.contact.films")["film"]
    at, faster = (Conditions(u, 0.03, 12e-3, 1e-11, 0.036, 1.8e-8) for u in (2.0, 4.0))
    assert film(500.0, faster) / film(500.0, at) == pytest.approx(2.0 ** (8 / 11), rel=1e-12)
    assert film(1000.0, at) / film(500.0, at) == pytest.approx(2.0 ** (-1 / 11), rel=1e-12)


def test_the_example_of_a_master_is_of_second_order_with_linear_signals() -> None:
    master = run_example("class Corrected", "orchestrator.masters")["Corrected"]("linear")
    errors = []
    for step in (2e-3, 1e-3):
        recorder = run_coupled(two_masses(), master, step, 2.0)
        errors.append(np.abs(recorder["first.position"] - exact(recorder.times)[:, 0]).max())
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)  # as for the other masters


def test_the_example_of_a_figure_draws_the_tyre_force() -> None:
    names = run_example("tyre_force", "orchestrator.plots")
    time, force = np.linspace(0.0, 1.0, 11), np.arange(11.0)
    data = FigureData(
        "a car", time, {"wheel.tyre_force": force}, time, {}, {"wheel.tyre_force": Quantity("N", "force")}
    )
    assert names["applies"](data)
    assert not names["applies"](replace(data, coupled={}))
    (axes,) = names["draw"](data).axes
    assert np.array_equal(axes.lines[0].get_ydata(), force)

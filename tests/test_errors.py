"""Errors: one family, with remedies that command line and Python say in their own words."""

import importlib
import inspect
import pickle
import pkgutil
import re
from pathlib import Path

import pytest

import tribocosim
from models.core.errors import group_elements
from models.core.remedies import Command, Option, Set, find_actions, in_command_line, in_python
from orchestrator.errors import another, name_source, one_of
from tribocosim.command_line.error_report import FAILED, MISTAKE, describe_error

# Those that no call of the package lets through.
INTERNAL = {
    "fmus.slave.FmuError",  # of an FMU's own process, which answers with a status
    "models.compile.cache_folder.UntrustedFolderError",  # an OSError: what is compiled isn't kept
    "orchestrator.participants.compiled_calls.NotCompiledError",  # calls are made one by one instead
}


@pytest.mark.parametrize(
    ("action", "typed", "called"),
    [
        (Option("out"), "--out", "out"),
        (Option("second_film", "wet"), "--second-film wet", "second_film='wet'"),
        (Option("overwrite", True), "--overwrite", "overwrite=True"),
        (Option("fmi", 1), "--fmi 1", "fmi=1"),
        (Option("from", "2000 rpm"), "--from '2000 rpm'", "low='2000 rpm'"),
        (Set("a.b", 1e-7), "--set a.b=1e-07", "with_({'a.b': 1e-07})"),
        (Set("a.b", "9 mm"), "--set 'a.b=9 mm'", "with_({'a.b': '9 mm'})"),
        (Set("a.b", True), "--set a.b=true", "with_({'a.b': True})"),
        (Command("resume", (Path("a/b"),)), "tribocosim resume a/b", "tribocosim.resume('a/b')"),
        (Command("run", (...,), (Option("overwrite", True),)), "tribocosim run ... --overwrite",
         "tribocosim.run(..., overwrite=True)"),
        (Command("fmu build"), "tribocosim fmu build", "tribocosim.build_fmu()"),
    ],
)  # fmt: skip
def test_each_face_says_an_action_in_its_own_words(action, typed: str, called: str) -> None:
    assert (in_command_line(action), in_python(action)) == (typed, called)


def test_an_error_ends_with_its_remedies_as_alternatives_also_inside_another() -> None:
    inner = tribocosim.MistakeError("x = 3: must be < 2", ("choose another ", Option("at")), "leave it out")
    for error in (inner, pickle.loads(pickle.dumps(inner))):
        outer = tribocosim.RunError(("part: ", error))
        assert str(outer) == "part: x = 3: must be < 2; choose another at, or leave it out"
        assert in_command_line(outer) == "part: x = 3: must be < 2; choose another --at, or leave it out"
        assert find_actions(outer) == (Option("at"),)


def test_a_file_named_before_each_line_leaves_the_actions_to_the_face() -> None:
    faults = tribocosim.MistakeError(("a: missing\n", "b: ", Option("out"), ": is taken"), another())
    assert in_command_line(name_source("study.toml", faults)).splitlines() == [
        "study.toml: a: missing",
        "study.toml: b: --out: is taken; choose another --out",
    ]


def test_of_many_names_an_error_gives_the_nearest_and_of_few_all() -> None:
    many = [f"part_{i}.force" for i in range(45)]
    assert one_of([*many, "valve.lift"], "valve.lft") == "did you mean valve.lift?"
    spring = [f"valve_spring.{name}" for name in ("preload", "lash", "spring_rate")]
    assert one_of([*many, *spring], "valve_spring.preloda") == "did you mean valve_spring.preload?"
    assert one_of(many, "x").endswith("part_11.force and 33 more")
    assert one_of(["jacobi", "newton"], "jacob") == "did you mean jacobi? It must be one of jacobi, newton"


def _list_error_classes() -> list[type[BaseException]]:
    found = {}
    for package in ("models", "fmus", "orchestrator", "tribocosim"):
        folder = importlib.import_module(package).__path__
        for module in pkgutil.walk_packages(folder, f"{package}."):
            text = Path(module.module_finder.find_spec(module.name).origin).read_text("utf-8")
            if re.search(r"^class \w*(Error|Faults)\b", text, re.MULTILINE):
                members = filter(inspect.isclass, vars(importlib.import_module(module.name)).values())
                errors = (
                    one for one in members if issubclass(one, Exception) and not issubclass(one, Warning)
                )
                found |= {one: None for one in errors if one.__module__ == module.name}
    return list(found)


def test_each_error_is_a_mistake_or_the_failure_of_a_run() -> None:
    classes = _list_error_classes()
    names = {f"{one.__module__}.{one.__name__}": one for one in classes}
    assert len(names) > 30
    family = (tribocosim.MistakeError, tribocosim.RunError)
    assert {name for name, one in names.items() if not issubclass(one, family)} - {
        "models.core.remedies.ExplainedError"
    } == INTERNAL
    assert not [name for name, one in names.items() if all(issubclass(one, kind) for kind in family)]


def test_exit_statuses_follow_from_the_family() -> None:
    assert describe_error(tribocosim.errors.ModelError("x", Option("out"))) == ("x; --out", MISTAKE)
    assert describe_error(tribocosim.RunError("x")) == ("x", FAILED)


def test_elements_of_an_array_stand_as_one_by_their_last_index():
    names = ["mass", "gap[1]", "gap[2]", "cams[1].lift", "cams[2].lift", "one[1]", "matrix[1,1]"]
    assert list(group_elements(names)) == ["mass", "gap[1..2]", "cams[1..2].lift", "one[1]", "matrix[1,1]"]

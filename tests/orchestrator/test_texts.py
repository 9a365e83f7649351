"""A text of any shape is read or refused with a sentence; none hangs."""

import math
import os
import re
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from orchestrator.analyses import load as load_analysis
from orchestrator.errors import MistakeError
from orchestrator.scenario import units
from orchestrator.scenario.files import load
from orchestrator.scenario.units import UnitError, to_unit
from orchestrator.study.files import load as load_study
from orchestrator.texts import DEEPEST, parse_json, parse_toml, parse_value, to_plain

# s of processor time. The slowest takes 0.4 s alone; squares and powers of these lengths take minutes.
LIMIT = 60.0
VALVE_TRAIN = 'extends = "valve-train"\n'
LIFT = "components.camshaft.parameters.lift"


def refuse(call: Callable[[], object], error: type[Exception] = MistakeError) -> str:
    """The message with which it is refused without hanging."""
    begun = time.process_time()
    with pytest.raises(error) as caught:
        call()
    assert time.process_time() - begun < LIMIT
    text = str(caught.value)
    assert len(text) < 3000
    assert all(c.isprintable() or c == "\n" for c in text)
    return text


UNITS = {
    "a power of a power": "10**10**10 s",
    "nested powers": "(((((10*s)**99)**99)**99)**99)",
    "other signs": "9^9^9^9^9 s",
    "a large power": "10**1000000000 s",
    "digits": "9" * 5000,
    "brackets": "(" * 5000 + "s" + ")" * 5000,
    "factors": "s" + "*s" * 50_000,
    "blanks": " " * 50_000 + "x",
    "prefixes": "mega" * 5000 + "s",
    "a name": "k" * 20_000,
    "letters that grow": "\ufdfa" * 3000,
    "a call": "__import__('os').system('id')",
    "a factorial": "s!!",
}


@pytest.mark.parametrize("case", UNITS)
def test_units(case):
    units._load_registry()
    refuse(lambda: to_unit(f"1 {UNITS[case]}", "s"), UnitError)


def test_torques_may_be_written_without_a_sign():
    for text, unit, value in (("3 Nm", "N.m", 3.0), ("2 kNm/rad", "N.m/rad", 2e3), ("4 Nmm", "J", 4e-3)):
        assert to_unit(text, unit) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize("unit", ["N/mm**2", "N/mm^2", "kg.m2/s2", "m^(1/2)", "mm2/s", "1/GPa", "m²"])
def test_powers_that_engineers_write_are_units(unit):
    assert units.to_base_units(unit) is not None


@pytest.mark.parametrize(
    ("line", "remedy"),
    [
        ("lash = 0.2 mm", 'a text, or a number with a unit, stands in quotes: lash = "0.2 mm"'),
        ("lash = 0.2mm # cold", 'in quotes: lash = "0.2mm"'),
        ("lash = 0,2 mm", 'in quotes: lash = "0.2 mm"'),
        ("lash = 0,2", "a number has a decimal point: lash = 0.2"),
        ("parameters = { law = 'a', lash = -.2 mm, mass = 3 }", 'in quotes: lash = "-.2 mm"'),
        ("parameters.angle = 20°", 'in quotes: parameters.angle = "20°"'),
        ("law = cycloidal", 'in quotes: law = "cycloidal"'),
        ("flexible = True", "write flexible = true"),
    ],
)
def test_a_value_without_its_quotes_is_told_with_them(line, remedy, tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(f"a = 1\n\n{line}\n", "utf-8")
    with pytest.raises(MistakeError) as error:
        load(file)
    said = rf"mine.toml: not a valid TOML file: .*\(at line 3, column \d+\); .*{re.escape(remedy)}$"
    assert re.search(said, str(error.value))


TEXTS = {
    "lists": "x = " + "[" * 50_000 + "]" * 50_000,
    "few lists": "x = " + "[" * (DEEPEST + 1) + "]" * (DEEPEST + 1),
    "tables": "x = " + "{a=" * 50_000 + "1" + "}" * 50_000,
    "a dotted key": ".".join("a" * 50_000) + " = 1",
    "a dotted header": "[" + ".".join("a" * 50_000) + "]",
    "digits": "stop_time = " + "1" * 5000,
    "fewer digits": "stop_time = " + "1" * 4000,
    "hexadecimal digits": "components.valve_spring.substeps = 0x" + "f" * 9000,
    "an unknown key": "x" * 1_000_000 + " = 1",
    "many unknown keys": "\n".join(f"k{i} = 1" for i in range(20_000)),
    "many tables": "\n".join(f"[components.c{i}]" for i in range(2000)),
    "a control character in a key": '"a\\u001b[31m" = 1',
    "one in a text": 'description = "\\u0007"',
    "a name of a file": f'extends = "{"x" * 5000}.toml"',
    "a name of a table": f'components.camshaft.lift_table = "{"x" * 5000}"',
    "a name": f'name = "{"x" * 300}"',
    "a connection": f'connections = ["{"a.b -> " * 50_000}"]',
    "a user": 'extends = "~nobody-here/a.toml"',
    "a device": 'extends = "/dev/zero"',
    "a number": f"{LIFT} = '{'1' * 100_000} m'",
    "quotes": '"' * 300_000,
}


@pytest.mark.parametrize("case", TEXTS)
def test_scenarios(case, tmp_path):
    file = tmp_path / "a.toml"
    text = TEXTS[case]
    file.write_text(text if "extends" in text else VALVE_TRAIN + text)
    refuse(lambda: load(file))


@pytest.mark.parametrize("value", ["[" * 50_000, "1" * 5000, "{a=" * 50_000, "{" + "a." * 50_000 + "a=1}"])
def test_settings(value):
    refuse(lambda: load("valve-train", [f"{LIFT}={value}"]))


def test_a_chain_of_files_that_extend_each_other(tmp_path):
    for i in range(1200):
        (tmp_path / f"{i}.toml").write_text(f'extends = "{i + 1}.toml"')
    (tmp_path / "1200.toml").write_text(VALVE_TRAIN)
    assert "extends more than" in refuse(lambda: load(tmp_path / "0.toml"))
    assert load(tmp_path / "1170.toml").name == "1170"


@pytest.mark.skipif(os.name != "posix", reason="has no named pipes")
@pytest.mark.parametrize("written", ['extends = "pipe"', 'components.camshaft.lift_table = "pipe"'])
def test_a_pipe_is_no_file(written, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "a.toml").write_text(written if "extends" in written else VALVE_TRAIN + written)
    refuse(lambda: load(tmp_path / "a.toml"))


HEADERS = {
    "blanks": "angle [" + " " * 100_000 + ", lift [mm]",
    "blanks in a unit": "angle [deg" + " " * 100_000 + "x], lift [mm]",
    "a power": "angle [deg], lift [10**10**10]",
    "brackets": "[(" * 50_000 + ", lift [mm]",
}


@pytest.mark.parametrize("case", HEADERS)
def test_headers_of_tables(case, tmp_path):
    (tmp_path / "a.csv").write_text(f"{HEADERS[case]}\n0,0\n1,1\n2,0\n")
    refuse(lambda: load("my-cam", [f"components.camshaft.lift_table={tmp_path / 'a.csv'}"]))


@pytest.mark.parametrize("cell", ["1" * 5000, "1e400", "1e" + "9" * 4500, "1e-" + "9" * 4500, "1," * 100_000])
def test_cells_of_tables(cell, tmp_path):
    (tmp_path / "a.csv").write_text(f"angle [deg], lift [mm]\n0,{cell}\n1,1\n2,0\n")
    refuse(lambda: load("my-cam", [f"components.camshaft.lift_table={tmp_path / 'a.csv'}"]))


PROGRAMS = [
    *("os:system", "subprocess:Popen", "os:abort", "sys:exit", "time:sleep", "builtins:breakpoint"),
    *("antigravity:x", "os:", ":", "a:b:c", "..x:y", "numpy:zeros", "numpy:pi", f"{'x' * 100_000}:y"),
    *("orchestrator.errors:MistakeError", "numpy:ndarray"),
]


@pytest.mark.parametrize("name", PROGRAMS)
def test_programs_that_give_no_component_and_no_analysis(name, tmp_path):
    """Those of Python are not even called."""
    (tmp_path / "a.toml").write_text(f'{VALVE_TRAIN}[components.extra]\ncomponent = "{name}"')
    refuse(lambda: load(tmp_path / "a.toml"))
    refuse(lambda: load_analysis(name))


def test_a_module_that_fails_or_ends_when_it_is_imported(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    for i, text in enumerate(("1 / 0", "raise SystemExit", "x = ")):
        (tmp_path / f"own_module_{i}.py").write_text(text)
        assert f"own_module_{i}:x" in refuse(lambda i=i: load_analysis(f"own_module_{i}:x"))  # type: ignore[misc]


def test_studies(tmp_path):
    for text in ("x = " + "[" * 50_000, "fixed.x = " + "1" * 5000):
        (tmp_path / "a.toml").write_text(text)
        refuse(lambda: load_study(str(tmp_path / "a.toml"), lambda scenario: None))  # type: ignore[arg-type, return-value]


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a":' * 100_000, f'{{"a": {"1" * 5000}}}', '["\\u0000"]'])
def test_json(text):
    refuse(lambda: parse_json(text), ValueError)


def test_what_is_read():
    assert parse_toml("a.b = 1\nc = [[1.5, 2.5]]") == {"a": {"b": 1}, "c": [[1.5, 2.5]]}
    assert parse_value(" 9 mm ") == "9 mm"
    assert parse_value("1\nx = 2") == "1\nx = 2"
    assert parse_value("[1, 2]") == [1, 2]
    large = "x = [" + ", ".join(["0.125"] * 100_000) + "]"
    assert len(parse_toml(large)["x"]) == 100_000


def test_a_byte_order_mark_says_nothing(tmp_path):
    (tmp_path / "plain.toml").write_text(VALVE_TRAIN, "utf-8")
    (tmp_path / "marked.toml").write_text(VALVE_TRAIN, "utf-8-sig")
    plain, marked = (load(tmp_path / f"{name}.toml") for name in ("plain", "marked"))
    assert marked.model_copy(update={"name": plain.name}) == plain


def test_what_json_cannot_have_is_refused_by_name():
    """Its repr would pass for an answer."""
    assert to_plain({"a": (1, math.nan, np.float64(2.0), Path("b"))}) == {"a": [1, None, 2.0, "b"]}
    with pytest.raises(TypeError, match="has no JSON"):
        to_plain([object()])

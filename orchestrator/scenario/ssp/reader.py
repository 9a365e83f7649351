"""Reads an SSP package as a scenario: ours with all settings, others with what they state."""

import hashlib
import logging
import re
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import fmpy
from lxml import etree

from models.core.component import Component
from models.core.quantities import Quantity
from models.core.system import suggestion

from ...participants.description import (
    CO_SIMULATION,
    MODEL_EXCHANGE,
    Description,
    DescriptionError,
    read_description,
)
from ...participants.third_party import ThirdPartyComponent, read_component
from ...texts import parse_json
from .. import ScenarioError
from ..arrays import check_sizes
from ..component_table import KINDS
from ..conversion import get_units
from ..values import WithUnit, build_component, list_layouts
from .lines import build_lines
from .names import NAMESPACES, OURS, STRUCTURE
from .structure import Path as Place
from .structure import Structure, read_structure
from .unpack import unpack, unpack_into_cache
from .values import StatedValue, read_values
from .writer import START

_log = logging.getLogger("tribocosim")
# The schemas of SSP 1, which fmpy contains, by the suffixes of files.
FOLDER = Path(fmpy.__file__).parent / "ssp" / "schema"
SCHEMAS = {".ssd": "Description", ".ssv": "ParameterValues", ".ssm": "ParameterMapping"}
# Steps of a run if no step size is stated.
STEPS = 1000

# Keys of a component's table that a package of ours may state; others could read any file here.
OWN_KEYS = (
    "component", "structure", "participant", "process", "interface", "memory_limit_mb", "substeps", "retries",
    "sha256",
)  # fmt: skip


def read_package(path: Path) -> dict[str, Any]:
    """The tables of the scenario; its FMUs are unpacked into the user's cache folder."""
    folder = unpack_into_cache(path)
    try:
        return _read_folder(path.name, folder)
    except ScenarioError:
        shutil.rmtree(folder, ignore_errors=True)  # what is refused takes no room
        raise


def unpack_package(path: Path, folder: Path) -> dict[str, Any]:
    """As `read_package`, with the FMUs unpacked into `folder`."""
    unpack(path, folder)
    return _read_folder(path.name, folder)


def _read_folder(name: str, folder: Path) -> dict[str, Any]:
    try:
        return _read(name, folder)
    except ScenarioError:
        raise
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        # Something is missing or is no number; what, the schema says better.
        said = error.args[0] if isinstance(error, KeyError) else error
        fault = find_schema_fault(folder) or said
        raise ScenarioError(f"{name}: not as SSP has it: {fault}; correct it") from None


def find_schema_fault(folder: Path) -> str:
    """The first violation of the standard in the folder's files of SSP 1, with its line; empty if none."""
    for file in sorted(folder.rglob("*")):
        if file.suffix not in SCHEMAS:
            continue
        try:
            root = etree.parse(str(file))
        except etree.XMLSyntaxError as error:
            return f"{file.relative_to(folder).as_posix()}: {error}"
        if not (root.getroot().get("version") or "1.0").startswith("1."):
            continue
        schema = etree.XMLSchema(etree.parse(str(FOLDER / f"SystemStructure{SCHEMAS[file.suffix]}.xsd")))
        if not schema.validate(root):
            first = schema.error_log[0]
            return f"{file.relative_to(folder).as_posix()}, line {first.line}: {first.message}"
    return ""


def _read(name: str, folder: Path) -> dict[str, Any]:
    file = folder / STRUCTURE
    if not file.is_file():
        raise ScenarioError(f"{name}: {STRUCTURE} is missing, so this is not an SSP; give another file")

    def read(path: str) -> bytes:
        try:
            return _locate(folder, path).read_bytes()
        except OSError:
            raise ScenarioError(f"{name}: {path} is not in the package; add it") from None

    found = read_structure(read, name)
    if found.experiment.get("startTime", 0.0) != 0.0:
        raise ScenarioError(
            f"{name}: startTime = {found.experiment['startTime']:g} s: runs begin at 0; shift the times"
        )
    fmus = {path: _locate(folder, source) for path, source in found.components.items()}
    settings = _read_settings(found, name)
    # An equilibrium is found again by the run.
    values = read_values(found, read, name, f"{START}.ssv" if settings.get("start") == "equilibrium" else "")
    tables = _build_tables(found, fmus, settings, name)
    for path, own in _name_components(fmus).items():
        if not tables[own].get("component"):
            _set_sizes(tables[own], values.get(path, {}), f"{name}: {own}")
    parts = {path: _find_component(tables[own], name, own) for path, own in _name_components(fmus).items()}
    content = settings or _build_defaults(found, fmus, name)
    content["components"] = tables
    names = _name_components(fmus)
    for path, stated in values.items():
        _set_values(tables[names[path]], parts[path], stated, f"{name}: {names[path]}")
    lines = build_lines(found, parts, names, name)
    for line in lines:
        target, _, variable = line.target.partition(".")
        if tables[target].get("inputs", {}).pop(variable, None) is not None:
            _log.warning("%s: %s is connected: its value is left out", name, line.target)
    content["connections"] = [str(line) for line in lines]
    if stop := found.experiment.get("stopTime"):
        content["stop_time"] = stop
    return content


def _locate(folder: Path, source: str) -> Path:
    """The file of a source, which is a URI reference; some tools write blanks and % as they are."""
    plain = folder / source
    return plain if plain.is_file() else folder / unquote(source)


def _read_settings(found: Structure, where: str) -> dict[str, Any]:
    """Our own annotation; empty without one."""
    for annotation in found.annotations:
        if annotation.get("type") == OURS and len(annotation):
            try:
                settings = dict(parse_json(annotation[0].text or ""))
                settings.pop("extends", None)  # another file, of whoever runs the package
                if ":" in str(dict(settings.get("master") or {}).get("name", "")):
                    del settings["master"]  # code that it would import
                return settings
            except ValueError as error:
                raise ScenarioError(
                    f"{where}: the annotation {OURS} is damaged: {error}; delete it"
                ) from None
    return {}


def _name_components(fmus: Mapping[Place, Path]) -> dict[Place, str]:
    """A scenario's name for each component: letters, digits and _, systems first."""
    names: dict[Place, str] = {}
    for path in fmus:
        plain = re.sub(r"\W", "_", "_".join(path))
        plain = plain if plain.isidentifier() else f"_{plain}"
        while plain in names.values():
            plain += "_"
        names[path] = plain
    return names


def _build_tables(
    found: Structure, fmus: Mapping[Place, Path], settings: Mapping[str, Any], where: str
) -> dict[str, Any]:
    tables: dict[str, Any] = {}
    for path, name in _name_components(fmus).items():
        if not fmus[path].is_file():
            raise ScenarioError(f"{where}: {found.components[path]} is not in the package; add it")
        own = _restrict(settings.get("components", {}).get(name, {}))
        ours = own.pop("sha256", "")
        built = own.get("participant", "fmu") in KINDS and own.get("component")
        # Our own FMU is built anew, unless somebody has put another one in its place.
        if not built or ours != hashlib.sha256(fmus[path].read_bytes()).hexdigest():
            own["participant"] = str(fmus[path])
            if own.get("process") != "own":  # only who runs the package lets a file of it into the run
                own.pop("process", None)
        if path in found.integrated:
            own["interface"] = MODEL_EXCHANGE
        tables[name] = own
    return tables


def _restrict(stated: Mapping[str, Any]) -> dict[str, Any]:
    """A component's table from a package, without keys that read files, and code that it would import."""
    own = {key: value for key, value in stated.items() if key in OWN_KEYS}
    if ":" in str(own.get("component", "")):
        del own["component"]
    return own


def _find_component(table: Mapping[str, Any], where: str, name: str) -> Component:
    try:
        if table.get("component"):
            return build_component(table["component"], tuple(sorted(table.get("structure", {}).items())))
        sizes = {name: int(size) for name, size in table.get("structure", {}).items()}
        path, interface = Path(table["participant"]), table.get("interface", CO_SIMULATION)
        check_sizes(path, interface, sizes)
        return read_component(path, interface, sizes)
    except ValueError as error:
        raise ScenarioError(f"{where}: {name}: {error}") from None


def _build_defaults(found: Structure, fmus: Mapping[Place, Path], where: str) -> dict[str, Any]:
    """The settings of a package that is not ours: the simplest master, in steps that somebody states."""
    about = [_read_description(path, where) for path in fmus.values()]
    stop = found.experiment.get("stopTime") or max((one.stop or 0.0 for one in about), default=0.0)
    if not stop:
        raise ScenarioError(f"{where}: nothing says when it ends; give its DefaultExperiment a stopTime")
    told = found.name != "ssp" and re.search(r"\w", found.name)  # as Dymola calls them all
    content = {
        "name": re.sub(r"[^\w .-]", "_", found.name if told else Path(where).stem),
        "description": " ".join(found.description.split()),
        "stop_time": stop,
        "macro_step": min(_find_step(found, about) or stop / STEPS, stop),
        "start": "given",
        "master": {"name": "jacobi", "extrapolation": "hold"},
        "reference": {"enabled": False},
    }
    return {key: value for key, value in content.items() if value != ""}


def _read_description(path: Path, where: str) -> Description:
    try:
        return read_description(path)
    except DescriptionError as error:
        raise ScenarioError(f"{where}: {path.name} {error}; give another file") from None


def _find_step(found: Structure, about: list[Description]) -> float:
    """The macro step (s) of another tool's annotation, or the least of the FMUs' own; 0: none is stated."""
    for annotation in found.annotations:
        for element in annotation.iter():
            for key in ("stepSize", "baseStepSize"):
                if NAMESPACES["ssd"] not in element.tag and element.get(key):
                    return float(element.get(key))
    return min((one.step for one in about if one.step), default=0.0)


def _set_sizes(table: dict[str, Any], stated: dict[str, StatedValue], where: str) -> None:
    """Move the values of structural parameters, on which the other variables depend, to their place."""
    about = _read_description(Path(table["participant"]), where)
    for name in [name for name in stated if name in about.structural]:
        value = stated.pop(name).value
        if not isinstance(value, float) or not value.is_integer():
            raise ScenarioError(f"{where}: {name} = {value}: must be a whole number; correct it")
        table.setdefault("structure", {})[name] = int(value)


def _set_values(
    table: dict[str, Any], component: Component, stated: Mapping[str, StatedValue], where: str
) -> None:
    """Put values where a scenario has them."""
    layouts = list_layouts(component)
    about = component.about if isinstance(component, ThirdPartyComponent) else None
    texts = about.strings if about else []
    for variable, one in stated.items():
        places = [
            (key, name)
            for key, layout in layouts.items()
            for name in layout.variables
            if variable == (name if about or key != "start" else layout.field(name).add_suffix("_start"))
        ]
        if not places and variable not in texts:
            # Sets are often shared between components, and larger than each.
            known = [name for layout in layouts.values() for name in layout.variables]
            _log.warning(
                "%s: no parameter, input or start value %r: left out (%s)",
                where,
                variable,
                suggestion(variable, known),
            )
            continue
        if one.plain != (variable in texts):
            here, there = ("a String", "not") if one.plain else ("no String", "one")
            raise ScenarioError(
                f"{where}: {variable} is {here} in the set, but {there} in the FMU; correct it"
            )
        if one.plain:
            driven = about is not None and about.variables[variable].causality == "input"
            place = "inputs" if driven else "parameters"
            table.setdefault(place, {})[variable] = one.value
            continue
        key, name = places[0]
        quantity = layouts[key].field(name).quantity
        value = one.value
        if isinstance(value, str) and not quantity.choices:
            # The variable's own numbers decide, says the standard.
            own = about.variables[variable].items if about else ()
            items = (one.items or {}) | dict(own)
            if value not in items:
                raise ScenarioError(
                    f"{where}: {variable}: enumeration item {value!r} is not defined; define it"
                )
            value = float(items[value])
        if isinstance(value, float) or (isinstance(value, bool) and one.way):
            value = _transform(float(value), one, quantity, component, f"{where}: {variable}")
        table.setdefault(key, {})[name] = value


def _transform(value: float, one: StatedValue, quantity: Quantity, component: Component, where: str) -> float:
    try:
        made = one.convert(value, quantity.unit, get_units(component), quantity.relative)
    except ValueError as error:
        raise ScenarioError(f"{where}: {error}; correct it") from None
    return WithUnit(made)  # in the FMU's, as SSP has it

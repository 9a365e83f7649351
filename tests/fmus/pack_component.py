"""An FMU of a component of the tests: slave, description and C layer are the packaged ones; the physics is
imported from the repository instead of shipped."""

import zipfile
from collections.abc import Callable
from pathlib import Path

from fmus.build import collect_binaries, origin
from fmus.fmi.description import GUID_PLACE, PYTHON, Experiment, model_description
from models.core.component import Component

_SCRIPT = """
import ctypes
from {module} import {factory} as make_component
from fmus.slave import slave_class
from models.core.integrator import FAILURES

# The C layer runs this file anew for every instance and gives back a reference that it was only lent.
ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))
try:
    {name} = globals()["{name}"]
except KeyError:
    {name} = slave_class(make_component(**{sizes!r}), "{name}", "test", FAILURES)
"""


def pack_component(factory: Callable[..., Component], folder: Path, **sizes: int) -> Path:
    """The file, named after the component."""
    component = factory(**sizes)
    name = component.name
    stem = "_".join([name, *(f"{key}{size}" for key, size in sizes.items())])
    xml = model_description(
        component, name, Experiment(stop_time=1.0, step_size=1e-3), origin("tests"), PYTHON
    )
    script = _SCRIPT.format(module=factory.__module__, factory=factory.__name__, name=name, sizes=sizes)
    path = folder / f"{name}.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", xml.replace(GUID_PLACE, f"{{{stem}}}"))
        archive.writestr(f"resources/{stem}.py", script)
        archive.writestr("resources/slavemodule.txt", stem)
        for place, content in collect_binaries(name, None).items():
            archive.writestr(place, content)
    return path

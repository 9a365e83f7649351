"""A train and its periods as WebAssembly, for a page that computes: `cycle_module(name, component, samples)`.

Every browser takes addresses of 32 bits. The translated kernels serve them too: only LLVM knows how long a
pointer is. The mathematical library is linked in, so that a module asks nothing of its host.
"""

from collections.abc import Callable, Mapping, Sequence

from models.compile.temporary import TemporaryFolder
from models.core.component import Component
from models.native.translate import TranslationError, translate

from .fmu import check_tools
from .machine_code import RUNTIME, STRICT, WEBASSEMBLY, Platform, object_code, run_zig

# What a page sets, reads and calls.
_ARRAYS = ("parameters", "inputs", "state", "start", "nominal", "held", "positive", "rows", "lows", "highs")
# Kernels keep small arrays on the stack.
_LINKED = ["-mexec-model=reactor", "-s", "-lm", "-Wl,--gc-sections", "-Wl,-z,stack-size=131072"]
_EXACT = ["-O2", "-ffp-contract=off", "-fno-sanitize=all"]


def cycle_module(
    name: str, component: Component, samples: int, progress: Callable[[float, str], object] = lambda *_: None
) -> bytes:
    """The module of a component without events, whose periods have so many samples.

    `progress` gets the share that is done, and what is done next. TranslationError for events, and for
    kernels that need Python; NativeBuildError without the tools.
    """
    if component.events is not None:
        raise TranslationError(f"{component.name}: has events, which a page does not look for")
    check_tools()
    exported = [f"-Wl,--export={one}" for one in (*_ARRAYS, "revolve")]
    sizes = list_sizes(component, samples)
    return link_cycle(name, WEBASSEMBLY, sizes, ["cycle.c"], [*_LINKED, *exported], progress)


def list_sizes(component: Component, samples: int) -> dict[str, int]:
    """What the C code calls the numbers of a component's variables."""
    return {
        "PARAMETERS": component.parameters.size,
        "INPUTS": component.inputs.size,
        "STATES": component.state.size,
        "OUTPUTS": component.outputs.size,
        "SAMPLES": samples,
    }


def link_cycle(
    name: str, place: Platform, sizes: Mapping[str, int], sources: Sequence[str], options: Sequence[str],
    progress: Callable[[float, str], object] = lambda *_: None,
) -> bytes:  # fmt: skip
    """The kernels of `name` with C files of the folder `browser`, for a platform."""
    progress(0.0, "its equations")  # shares as measured
    kernels = translate(name, {}, ("derivative", "output"))
    progress(0.8, "machine code")
    with TemporaryFolder() as here:
        (here / "kernels.o").write_bytes(object_code(place, [kernels]))
        (here / "sizes.h").write_text("".join(f"#define {key} {size}\n" for key, size in sizes.items()))
        for path in (RUNTIME / "kernels.h", *(RUNTIME.parent / "browser").iterdir()):
            (here / path.name).write_bytes(path.read_bytes())
        target = f"cycle{place.suffix}"
        run_zig(
            [
                "cc", "-target", place.zig, "-std=c11", *_EXACT, *STRICT, "-I.", *sources, "kernels.o",
                *options, "-o", target,
            ],
            here,
        )  # fmt: skip
        return (here / target).read_bytes()

"""A module as a component of WebAssembly: the world co-simulation-fmu of the draft FMI-LS-WASM.

Of such a component only the module differs. What stands around it, types and adapters of all functions, is
the template, which interop/component_template.py makes.
"""

from pathlib import Path

TEMPLATE = Path(__file__).parent / "runtime" / "component.bin"
# A section with an empty module, where the module goes.
PLACE = b"\x01\x08\0asm\x01\0\0\0"


def wrap(module: bytes) -> bytes:
    """The component of a module that is linked from runtime/fmi3_component.c."""
    return TEMPLATE.read_bytes().replace(PLACE, b"\x01" + write_number(len(module)) + module, 1)


def write_number(value: int) -> bytes:
    """LEB128: seven bits a byte, the lowest first."""
    low, rest = value & 0x7F, value >> 7
    return bytes([low | 0x80]) + write_number(rest) if rest else bytes([low])

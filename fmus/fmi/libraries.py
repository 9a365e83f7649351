"""Read format, processor and exported names from the headers of shared libraries, without loading them.

ELF, PE and Mach-O are read if they are little-endian, as on all platforms of FMI. Sources: System V
ABI, chapters 4 and 5 (and its GNU hash section); Microsoft's PE Format; Apple's mach-o/loader.h and dyld's
trie of exports.
"""

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from models.core.errors import MistakeError

ELF, PE, MACH_O = "ELF", "PE", "Mach-O"
# Processors as FMI 3.0 calls them, by the number in the header.
_OF_ELF = {3: "x86", 40: "aarch32", 62: "x86_64", 183: "aarch64", 243: "riscv64"}
_OF_PE = {0x14C: "x86", 0x1C4: "aarch32", 0x8664: "x86_64", 0xAA64: "aarch64"}
_OF_MACH_O = {7: "x86", 12: "aarch32", 0x01000007: "x86_64", 0x0100000C: "aarch64"}


class LibraryError(MistakeError):
    """The content is no whole shared library; the message says why, without the file's name."""


@dataclass(frozen=True)
class Library:
    """A shared library for one processor; `exports` are the names of the symbols that it exports."""

    format: str
    processor: str
    exports: frozenset[str]


def libraries(content: bytes) -> list[Library]:
    """The library in a file, or those for several processors in a universal one of macOS."""
    try:
        return [_read(part) for part in _split_universal(content)]
    except struct.error:
        raise LibraryError("is cut off: a table of its header lies beyond the end of the file") from None


def _split_universal(content: bytes) -> Iterator[bytes]:
    if content[:4] != b"\xca\xfe\xba\xbe":
        yield content
        return
    for i in range(struct.unpack_from(">I", content, 4)[0]):
        start, size = struct.unpack_from(">II", content, 8 + 20 * i + 8)
        yield _cut_out(content, start, size)


def _cut_out(content: bytes, start: int, size: int) -> bytes:
    if start + size > len(content):
        raise LibraryError(
            f"is cut off: its header tells of at least {start + size} bytes, {len(content)} are there"
        )
    return content[start : start + size]


def _read(content: bytes) -> Library:
    for magic, read in _READERS.items():
        if content.startswith(magic):
            return read(content)
    raise LibraryError(f"is no shared library of Linux, Windows or macOS (it begins with {content[:4]!r})")


def _name_processor(processors: dict[int, str], number: int) -> str:
    return processors.get(number, f"processor number {number}")


def _read_string(content: bytes, start: int) -> str:
    end = content.find(b"\0", start)
    if not 0 <= start <= end:
        raise LibraryError("has names that lie beyond the end of the file")
    return content[start:end].decode(errors="replace")


def _read_elf(content: bytes) -> Library:
    wide, order = struct.unpack_from("BB", content, 4)
    if order != 1:
        raise LibraryError("is for a processor whose numbers begin with the highest byte")
    kind, machine = struct.unpack_from("<HH", content, 16)
    if kind != 3:
        raise LibraryError(f"is an ELF file of type {kind}: must be 3, a shared object")
    word, size = ("Q", 8) if wide == 2 else ("I", 4)
    (segments, sections) = struct.unpack_from(f"<{word}{word}", content, 24 + size)
    each, count, section, section_count = struct.unpack_from("<HHHH", content, 30 + 3 * size)
    _cut_out(content, sections, section * section_count)
    loaded, dynamic = [], b""
    for i in range(count):
        at = segments + each * i
        if wide == 2:
            what, _, start, address, _, length = struct.unpack_from("<IIQQQQ", content, at)
        else:
            what, start, address, _, length = struct.unpack_from("<IIIII", content, at)
        piece = _cut_out(content, start, length)
        if what == 1:
            loaded.append((address, start, length))
        elif what == 2:
            dynamic = piece
    tags = dict(struct.iter_unpack(f"<{word}{word}", dynamic))
    locate = _make_locator(loaded)
    if not {5, 6} <= set(tags):  # strings and symbols
        raise LibraryError("has no table of what it exports")
    names, symbols = locate(tags[5]), locate(tags[6])
    exports = set()
    for i in range(_count_elf_symbols(content, tags, locate, size)):
        if wide == 2:
            name, info, other, index = struct.unpack_from("<IBBH", content, symbols + 24 * i)
        else:
            name, _, _, info, other, index = struct.unpack_from("<IIIBBH", content, symbols + 16 * i)
        # Global, weak or unique, defined here, and neither hidden nor internal.
        if info >> 4 in (1, 2, 10) and index and other & 3 in (0, 3):
            exports.add(_read_string(content, names + name))
    return Library(ELF, _name_processor(_OF_ELF, machine), frozenset(exports))


def _count_elf_symbols(content: bytes, tags: dict[int, int], locate: Callable[[int], int], size: int) -> int:
    """Count the symbols. Only the hash tables hold their number."""
    if 4 in tags:
        return int(struct.unpack_from("<I", content, locate(tags[4]) + 4)[0])
    if 0x6FFFFEF5 not in tags:
        return 0
    at = locate(tags[0x6FFFFEF5])
    buckets, first, words, _ = struct.unpack_from("<IIII", content, at)
    at += 16 + words * size
    last = max(struct.unpack_from(f"<{buckets}I", content, at), default=0)
    if last < first:
        return int(first)
    while not struct.unpack_from("<I", content, at + 4 * (buckets + last - first))[0] & 1:
        last += 1  # a chain ends with an odd number
    return int(last) + 1


def _make_locator(loaded: list[tuple[int, int, int]]) -> Callable[[int], int]:
    """Return a function from an address in memory to the offset in the file."""

    def locate(address: int) -> int:
        for start, offset, length in loaded:
            if start <= address < start + length:
                return offset + address - start
        raise LibraryError(f"has a table at the address {address:#x}, which is nowhere in the file")

    return locate


def _read_pe(content: bytes) -> Library:
    (start,) = struct.unpack_from("<I", content, 0x3C)
    if content[start : start + 4] != b"PE\0\0":
        raise LibraryError("begins as a program of DOS, and has no PE header")
    machine, count, _, _, _, optional, traits = struct.unpack_from("<HHIIIHH", content, start + 4)
    if not traits & 0x2000:
        raise LibraryError("is a program of Windows, not a DLL")
    head = start + 24
    (magic,) = struct.unpack_from("<H", content, head)
    loaded = []
    for i in range(count):
        at = head + optional + 40 * i
        _, address, length, offset = struct.unpack_from("<IIII", content, at + 8)
        _cut_out(content, offset, length)
        loaded.append((address, offset, length))
    locate = _make_locator(loaded)
    (exported,) = struct.unpack_from("<I", content, head + (112 if magic == 0x20B else 96))
    exports: tuple[Any, ...] = ()
    if exported:
        names, _, table = struct.unpack_from("<I4sI", content, locate(exported) + 24)
        exports = struct.unpack_from(f"<{names}I", content, locate(table)) if names else ()
    return Library(
        PE,
        _name_processor(_OF_PE, machine),
        frozenset(_read_string(content, locate(name)) for name in exports),
    )


def _read_mach_o(content: bytes) -> Library:
    wide = content[0] == 0xCF
    machine, _, kind, count = struct.unpack_from("<IIII", content, 4)
    if kind not in (6, 8):
        raise LibraryError(f"is a Mach-O file of type {kind}: must be 6, a library, or 8, a bundle")
    at, exports = 32 if wide else 28, set[str]()
    for _ in range(count):
        command, length = struct.unpack_from("<II", content, at)
        if command == 0x19:  # a segment
            _cut_out(content, *struct.unpack_from("<QQ", content, at + 40))
        elif command == 1:
            _cut_out(content, *struct.unpack_from("<II", content, at + 32))
        elif command in (0x22, 0x80000022):  # what the loader needs, exports last
            exports |= _collect_trie_names(_cut_out(content, *struct.unpack_from("<II", content, at + 40)))
        elif command == 0x80000033:
            exports |= _collect_trie_names(_cut_out(content, *struct.unpack_from("<II", content, at + 8)))
        elif command == 2:  # symbols, for those who link and look for faults
            _, _, texts, size = struct.unpack_from("<IIII", content, at + 8)
            _cut_out(content, texts, size)
        if length < 8:
            raise LibraryError("has a damaged header: a load command without a length")
        at += length
    return Library(MACH_O, _name_processor(_OF_MACH_O, machine), frozenset(exports))


def _collect_trie_names(tree: bytes) -> set[str]:
    """Collect the names in the prefix tree of exports."""
    names, left = set(), [(0, b"")] if tree else []
    seen = set()
    while left:
        at, name = left.pop()
        if at in seen:
            raise LibraryError("has a damaged table of what it exports")
        seen.add(at)
        ends, at = _read_uleb128(tree, at)
        if ends:
            names.add(name.decode(errors="replace").removeprefix("_"))
        at += ends
        (branches,) = struct.unpack_from("B", tree, at)
        at += 1
        for _ in range(branches):
            more = _read_string(tree, at).encode()
            to, at = _read_uleb128(tree, at + len(more) + 1)
            left.append((to, name + more))
    return names


def _read_uleb128(content: bytes, at: int) -> tuple[int, int]:
    """Read an integer with seven bits in each byte (ULEB128); return it and the offset behind it."""
    value = shift = 0
    while True:
        (byte,) = struct.unpack_from("B", content, at)
        value |= (byte & 0x7F) << shift
        at, shift = at + 1, shift + 7
        if byte < 0x80:
            return value, at


_READERS = {
    b"\x7fELF": _read_elf,
    b"MZ": _read_pe,
    b"\xcf\xfa\xed\xfe": _read_mach_o,
    b"\xce\xfa\xed\xfe": _read_mach_o,
}

"""Directional derivatives of kernels: forward-mode differentiation of their compiled code.

Every floating-point value gets a tangent, every pointer one to the tangents of what it points to, and every
instruction is followed by its derivative. So the code that runs is differentiated, branch by branch, and not
a formula beside it or a difference of two runs; what remains is rounding. At a kink the derivative is that of
the branch that is taken. A function that a kernel calls becomes a function that computes its tangent as well.

    kernel_output(t, x, u, p, y)  becomes  tangent_output(t, dt, x, dx, u, du, p, dp, y, dy).
"""

import re
from collections.abc import Iterator, Mapping, Sequence, Set
from typing import Any

from ..core.errors import MistakeError
from .rules import RULES, ZERO, Code

# Instructions that have no tangent: of whole numbers, comparisons, jumps.
_INSTRUCTIONS = """
add sub mul sdiv udiv srem urem shl lshr ashr and or xor icmp fcmp fptosi fptoui sext zext trunc br ret switch
unreachable
"""
_WITHOUT = frozenset(_INSTRUCTIONS.split())
_NO_POINTER = "null"
_KERNEL, _TANGENT = "kernel_", "tangent_"
_IGNORED = ("@llvm.lifetime", "@llvm.assume", "@llvm.experimental.noalias")


class DifferentiationError(MistakeError):
    """An instruction whose derivative is not known; the message shows it."""


def differentiate(kernels: str, entries: Sequence[str]) -> str:
    """tangent_<entry> in LLVM's language, for these entries of translated `kernels`."""
    module = _simplify(kernels, {_KERNEL + entry for entry in entries})
    functions = [f for f in module.functions if not f.is_declaration]
    made = {f.name: _TANGENT + f.name.removeprefix(_KERNEL) for f in functions}
    tangents = [_write_tangent(f, made) for f in functions]
    known = {f.name for f in module.functions} | set(made.values())
    calls = sorted(set(re.findall(r"= call double @([\w.]+)\((.*)\)", "\n".join(tangents))))
    new = {
        name: f"declare double @{name}({', '.join('double' for _ in arguments.split(','))})"
        for name, arguments in calls
        if name not in known
    }
    whole = llvm().parse_assembly("\n".join([str(module), *new.values(), *tangents]))
    for f in whole.functions:
        if f.name in made:
            f.linkage = "internal"
    _run(whole, "global_dead_code_eliminate")
    return str(whole)


def llvm() -> Any:
    """llvmlite's binding, ready for every platform; imported late, as that takes time."""
    import llvmlite.binding

    llvmlite.binding.initialize_all_targets()
    llvmlite.binding.initialize_all_asmprinters()
    return llvmlite.binding


def _simplify(kernels: str, names: Set[str]) -> Any:
    """The module with these functions and what they call, every value named."""
    module = llvm().parse_assembly(kernels)
    for f in module.functions:
        if not f.is_declaration and f.name not in names:
            f.linkage = "internal"
    _run(module, speed=2)
    _run(module, "instruction_namer")
    return module


def _run(module: Any, name: str = "", speed: int = 0) -> None:
    """The pass of that name, or the standard ones, without those that make vectors."""
    binding = llvm()
    machine = binding.Target.from_default_triple().create_target_machine()
    tuning = binding.create_pipeline_tuning_options(speed_level=speed)
    tuning.loop_vectorization = tuning.slp_vectorization = tuning.loop_unrolling = False
    builder = binding.create_pass_builder(machine, tuning)
    passes = binding.create_new_module_pass_manager() if name else builder.getModulePassManager()
    if name:
        getattr(passes, f"add_{name}_pass")()
    passes.run(module, builder)


def _write_tangent(function: Any, made: Mapping[str, str]) -> str:
    """The text of the function that computes another and its tangent; `made`: the names of all of them."""
    # The first two arguments of kernels are numba's: they hold nothing that has a tangent.
    kernel = function.name.startswith(_KERNEL)
    exempt = {argument.name for argument in list(function.arguments)[: 2 * kernel]}
    code = Code()
    kind = str(function.global_value_type).partition(" ")[0]
    # They run where a host asks for derivatives, so that their size counts more than their speed.
    code.lines.append(
        f"define {'' if kernel else 'internal '}{kind} @{_quote(made[function.name])}"
        f"({', '.join(_arguments(function, exempt))}) minsize optsize {{"
    )
    tangents = _Tangents(code, exempt | _find_constant_pointers(function), made)
    for block in function.blocks:
        code.lines.append(f"{_quote(block.name)}:")
        instructions = [i for i in block.instructions if not any(name in str(i) for name in _IGNORED)]
        phis = sum(i.opcode == "phi" for i in instructions)
        code.lines += map(_text, instructions[:phis])
        for i in instructions[:phis]:
            tangents.differentiate_phi(i)
        for i in instructions[phis:]:
            if tangents.calls(i):
                tangents.differentiate_call(i)
                continue
            code.lines.append(_text(i))
            if i.opcode not in _WITHOUT:
                tangents.differentiate(i)
    return "\n".join([*code.lines, "}"])


def _arguments(function: Any, exempt: Set[str]) -> Iterator[str]:
    for argument in function.arguments:
        kind, name = str(argument.type), _local(argument.name)
        yield f"{kind} {name}"
        if argument.name not in exempt and kind in ("double", "ptr"):
            yield f"{kind} {_shadow(argument.name)}"


def _find_constant_pointers(function: Any) -> Set[str]:
    """Names of pointers into the module's constants: all are, of which nothing shows that they are not."""
    moved = [i for block in function.blocks for i in block.instructions if str(i.type) == "ptr"]
    of = {i.name: list(i.operands)[:1] if i.opcode == "getelementptr" else list(i.operands) for i in moved}
    found = {i.name for i in moved if i.opcode in ("getelementptr", "phi")}
    while True:
        fewer = {name for name in found if all(p.is_constant or p.name in found for p in of[name])}
        if fewer == found:
            return found
        found = fewer


class _Tangents:
    """Writes the derivative of each instruction after it."""

    def __init__(self, code: Code, exempt: Set[str], made: Mapping[str, str]) -> None:
        self.code, self.made = code, made
        # Tangents that are known to be nothing, by the name of their value.
        self.nothing = dict.fromkeys(exempt, _NO_POINTER)
        # Pointers of which some lead to constants, which have no place for tangents.
        self.lost: set[str] = set()

    def calls(self, i: Any) -> bool:
        """Whether it is a call of a function that has a tangent."""
        return i.opcode == "call" and list(i.operands)[-1].name in self.made

    def differentiate_call(self, i: Any) -> None:
        """Such a call: that of the function that computes its tangent as well, in its place."""
        *arguments, function = i.operands
        given = []
        for argument in arguments:
            kind = str(argument.type)
            given.append(f"{kind} {_value(argument)}")
            if kind == "ptr" and self._is_lost(argument):
                raise _unknown(i)
            if kind in ("double", "ptr"):
                given.append(f"{kind} {self._pass_argument(argument)}")
        kind, result = str(i.type), f"{_local(i.name)} = " if i.name else ""
        if kind in ("double", "ptr"):
            raise _unknown(i)
        name = _quote(self.made[function.name])
        self.code.lines.append(f"  {result}call {kind} @{name}({', '.join(given)})")

    def differentiate_phi(self, phi: Any) -> None:
        kind = str(phi.type)
        if kind in ("double", "ptr"):
            pairs = list(zip(phi.operands, phi.incoming_blocks, strict=True))
            known = phi.name in self.nothing
            if kind == "ptr" and not known and any(self._is_lost(value) for value, _ in pairs):
                self.lost.add(phi.name)
            arms = (f"[ {self._pass_argument(value)}, {_local(block.name)} ]" for value, block in pairs)
            self.code.lines.append(f"  {_shadow(phi.name)} = phi {kind} {', '.join(arms)}")

    def differentiate(self, i: Any) -> None:
        """Any other instruction."""
        known = getattr(self, f"_differentiate_{i.opcode}", None)
        if known is None:
            raise _unknown(i)
        tangent = known(i, *i.operands)
        kind = str(i.type)
        if tangent is None or kind not in ("double", "ptr"):
            return
        if tangent in (ZERO, _NO_POINTER):
            self.nothing[i.name] = tangent
        # A second name for it, of the one form that later uses expect; LLVM sees through it.
        self.code.lines.append(f"  {_shadow(i.name)} = select i1 true, {kind} {tangent}, {kind} {tangent}")

    def _is_lost(self, pointer: Any) -> bool:
        """Whether what is read there has no tangent though what is read at another may have one."""
        constant = pointer.is_constant and _value(pointer) != _NO_POINTER
        return constant or pointer.name in self.lost or pointer.name in self.nothing

    def _pass_argument(self, value: Any) -> str:
        """The tangent of an operand, by its name where it has one."""
        if value.is_constant:
            return ZERO if str(value.type) == "double" else _NO_POINTER
        return _shadow(value.name)

    def _tangent(self, value: Any) -> str:
        """The tangent of an operand; ZERO or null where it is known to be nothing."""
        if value.is_constant:
            return ZERO if str(value.type) == "double" else _NO_POINTER
        return self.nothing.get(value.name) or _shadow(value.name)

    def _differentiate_fadd(self, i: Any, a: Any, b: Any) -> str:
        return self.code.add(self._tangent(a), self._tangent(b))

    def _differentiate_fsub(self, i: Any, a: Any, b: Any) -> str:
        return self.code.subtract(self._tangent(a), self._tangent(b))

    def _differentiate_fmul(self, i: Any, a: Any, b: Any) -> str:
        times = self.code.times
        return self.code.add(times(self._tangent(a), _value(b)), times(_value(a), self._tangent(b)))

    def _differentiate_fdiv(self, i: Any, a: Any, b: Any) -> str:
        change = self.code.subtract(self._tangent(a), self.code.times(_value(i), self._tangent(b)))
        return self.code.over(change, _value(b))

    def _differentiate_frem(self, i: Any, a: Any, b: Any) -> str:
        return self._tangent(a)

    def _differentiate_fneg(self, i: Any, a: Any) -> str:
        return self.code.negative(self._tangent(a))

    def _differentiate_extractvalue(self, i: Any, whole: Any) -> None:
        """Of a whole number and whether it is too large."""
        if str(whole.type) != "{ i64, i1 }":
            raise _unknown(i)

    def _differentiate_freeze(self, i: Any, a: Any) -> str | None:
        return self._tangent(a) if str(i.type) == "double" else None

    def _differentiate_sitofp(self, i: Any, a: Any) -> str:
        return ZERO

    _differentiate_uitofp = _differentiate_sitofp

    def _differentiate_select(self, i: Any, met: Any, a: Any, b: Any) -> str | None:
        kind = str(i.type)
        if kind not in ("double", "ptr"):
            return None
        then, otherwise = self._tangent(a), self._tangent(b)
        if then == otherwise:
            return then
        return self.code(f"select i1 {_value(met)}, {kind} {then}, {kind} {otherwise}")

    def _differentiate_getelementptr(self, i: Any, base: Any, *indices: Any) -> str:
        shadow = self._tangent(base)
        if base.name in self.lost:
            self.lost.add(i.name)
        if shadow == _NO_POINTER:
            return shadow
        head, comma, tail = _text(i).partition(f"ptr {_value(base)},")
        if not comma:
            raise _unknown(i)
        return self.code(f"{head.partition('= ')[2]}ptr {shadow},{tail}")

    def _differentiate_alloca(self, i: Any, count: Any) -> str:
        return self.code(_text(i).partition("= ")[2])

    def _differentiate_load(self, i: Any, place: Any) -> str | None:
        kind, shadow = str(i.type), self._tangent(place)
        if place.name in self.lost:
            raise _unknown(i)
        if kind != "double":
            # Whole numbers may be loaded from memory of the module's own.
            if shadow != _NO_POINTER:
                raise _unknown(i)
            return None
        return ZERO if shadow == _NO_POINTER else self.code(f"load double, ptr {shadow}, align 1")

    def _differentiate_store(self, i: Any, value: Any, place: Any) -> None:
        shadow, kind = self._tangent(place), str(value.type)
        if shadow == _NO_POINTER or (kind == "ptr" and _value(value) == "null"):
            return
        if kind != "double":
            raise _unknown(i)
        self.code.lines.append(f"  store double {self._tangent(value)}, ptr {shadow}, align 1")

    def _differentiate_call(self, i: Any, *operands: Any) -> str | None:
        *arguments, function = operands
        name = function.name
        if name.startswith("llvm.memset"):
            shadow = self._tangent(arguments[0])
            byte, size = map(_value, arguments[1:3])
            if byte != "0":
                raise _unknown(i)
            self.code.lines.append(
                f"  call void @llvm.memset.p0.i64(ptr align 1 {shadow}, i8 0, i64 {size}, i1 false)"
            )
            return None
        if str(i.type) != "double":
            return None
        tangents = tuple(map(self._tangent, arguments))
        if all(tangent == ZERO for tangent in tangents):
            return ZERO
        rule = RULES.get(name.removeprefix("llvm.").removesuffix(".f64"))
        if rule is None:
            raise _unknown(i)
        return rule(self.code, _value(i), tuple(map(_value, arguments)), tangents)


def _unknown(instruction: Any) -> DifferentiationError:
    return DifferentiationError(f"no derivative is known of {str(instruction).strip()}")


def _text(instruction: Any) -> str:
    """The instruction without notes on it, whose numbers are not those of the module."""
    return re.sub(r"(, ![\w.]+ ![0-9]+| #[0-9]+)+$", "", str(instruction))


def _value(value: Any) -> str:
    """An operand as it stands in instructions."""
    if value.is_constant and not value.is_global:
        return str(value).partition(" ")[2]
    return f"@{_quote(value.name)}" if value.is_global else _local(value.name)


def _local(name: str) -> str:
    return "%" + _quote(name)


def _shadow(name: str) -> str:
    """The name of a value's tangent."""
    return _local(name + ".d")


def _quote(name: str) -> str:
    return name if re.fullmatch(r"[-\w$.]+", name) else f'"{name}"'

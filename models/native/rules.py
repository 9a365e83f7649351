"""The derivatives of elementary functions, as code in LLVM's language: RULES["sin"](code, r, (a,), (da,)).

Each rule gives the tangent of the result r from the arguments and their tangents, of which at least one is
not ZERO.
"""

from collections.abc import Callable, Mapping

ZERO = "0.0"
TWO_OVER_ROOT_PI = "0x3FF20DD750429B6D"  # 2/sqrt(pi), as erf's derivative at 0


class Code:
    """Lines that compute; what is known to be zero is left out."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._count = 0

    def __call__(self, expression: str) -> str:
        """The name of the result of a new line."""
        self._count += 1
        name = f"%d.{self._count}"
        self.lines.append(f"  {name} = {expression}")
        return name

    def add(self, a: str, b: str) -> str:
        if ZERO in (a, b):
            return b if a == ZERO else a
        return self(f"fadd double {a}, {b}")

    def subtract(self, a: str, b: str) -> str:
        if b == ZERO:
            return a
        return self.negative(b) if a == ZERO else self(f"fsub double {a}, {b}")

    def times(self, a: str, b: str) -> str:
        return ZERO if ZERO in (a, b) else self(f"fmul double {a}, {b}")

    def over(self, a: str, b: str) -> str:
        return ZERO if a == ZERO else self(f"fdiv double {a}, {b}")

    def negative(self, a: str) -> str:
        return ZERO if a == ZERO else self(f"fneg double {a}")

    def call(self, name: str, *arguments: str) -> str:
        return self(f"call double @{name}({', '.join(f'double {a}' for a in arguments)})")

    def where(self, comparison: str, a: str, b: str, then: str, otherwise: str) -> str:
        if then == otherwise:
            return then
        met = self(f"fcmp {comparison} double {a}, {b}")
        return self(f"select i1 {met}, double {then}, double {otherwise}")


Rule = Callable[[Code, str, tuple[str, ...], tuple[str, ...]], str]


def _unary(slope: Callable[[Code, str, str], str]) -> Rule:
    """Of a function of one argument: slope(code, r, a) times its tangent."""
    return lambda code, r, a, d: code.times(slope(code, r, a[0]), d[0])


def _square_root(code: Code, r: str, a: tuple[str, ...], d: tuple[str, ...]) -> str:
    """Zero where the argument does not change, also at zero, where the slope is infinite."""
    slope = code.over(d[0], code.times("2.0", r))
    return code.where("oeq", d[0], ZERO, ZERO, slope)


def _power(code: Code, r: str, a: tuple[str, ...], d: tuple[str, ...]) -> str:
    """As the root: what does not change adds nothing, also where the slope is infinite."""
    (base, exponent), (db, de) = a, d
    total = ZERO
    if db != ZERO:
        lower = code.call("llvm.pow.f64", base, code.subtract(exponent, "1.0"))
        total = code.where("oeq", db, ZERO, ZERO, code.times(code.times(exponent, lower), db))
    if de != ZERO:
        turned = code.times(code.times(r, code.call("llvm.log.f64", base)), de)
        total = code.add(total, code.where("oeq", de, ZERO, ZERO, turned))
    return total


def _differentiate_atan2(code: Code, r: str, a: tuple[str, ...], d: tuple[str, ...]) -> str:
    (y, x), (dy, dx) = a, d
    square = code.add(code.times(x, x), code.times(y, y))
    return code.over(code.subtract(code.times(x, dy), code.times(y, dx)), square)


def _differentiate_fma(code: Code, r: str, a: tuple[str, ...], d: tuple[str, ...]) -> str:
    return code.add(code.add(code.times(a[0], d[1]), code.times(d[0], a[1])), d[2])


def _keep_size(code: Code, r: str, a: tuple[str, ...], d: tuple[str, ...]) -> str:
    return code.where("oeq", r, a[0], d[0], code.negative(d[0]))


def _root_of_one_and(code: Code, sign: str, a: str) -> str:
    """sqrt(1 + sign a^2)."""
    square = code.times(a, a)
    whole = code.add("1.0", square) if sign == "+" else code.subtract("1.0", square)
    return code.call("llvm.sqrt.f64", whole)


def _bell(code: Code, a: str) -> str:
    """2/sqrt(pi) exp(-a^2)."""
    return code.times(TWO_OVER_ROOT_PI, code.call("llvm.exp.f64", code.negative(code.times(a, a))))


RULES: Mapping[str, Rule] = {
    "sqrt": _square_root,
    "pow": _power,
    "atan2": _differentiate_atan2,
    "hypot": lambda code, r, a, d: code.over(code.add(*map(code.times, a, d)), r),
    "copysign": _keep_size,
    "fma": _differentiate_fma,
    "fmuladd": _differentiate_fma,
    "fabs": _keep_size,
    "minnum": lambda code, r, a, d: code.where("oeq", r, a[0], *d),
    "maxnum": lambda code, r, a, d: code.where("oeq", r, a[0], *d),
    "floor": lambda code, r, a, d: ZERO,
    "ceil": lambda code, r, a, d: ZERO,
    "trunc": lambda code, r, a, d: ZERO,
    "fmod": lambda code, r, a, d: d[0],
    "sin": _unary(lambda code, r, a: code.call("llvm.cos.f64", a)),
    "cos": _unary(lambda code, r, a: code.negative(code.call("llvm.sin.f64", a))),
    "tan": _unary(lambda code, r, a: code.add("1.0", code.times(r, r))),
    "asin": _unary(lambda code, r, a: code.over("1.0", _root_of_one_and(code, "-", a))),
    "acos": _unary(lambda code, r, a: code.over("-1.0", _root_of_one_and(code, "-", a))),
    "atan": _unary(lambda code, r, a: code.over("1.0", code.add("1.0", code.times(a, a)))),
    "sinh": _unary(lambda code, r, a: code.call("cosh", a)),
    "cosh": _unary(lambda code, r, a: code.call("sinh", a)),
    "tanh": _unary(lambda code, r, a: code.subtract("1.0", code.times(r, r))),
    "asinh": _unary(lambda code, r, a: code.over("1.0", _root_of_one_and(code, "+", a))),
    "exp": _unary(lambda code, r, a: r),
    "expm1": _unary(lambda code, r, a: code.add("1.0", r)),
    "log": _unary(lambda code, r, a: code.over("1.0", a)),
    "erf": _unary(lambda code, r, a: _bell(code, a)),
    "erfc": _unary(lambda code, r, a: code.negative(_bell(code, a))),
}

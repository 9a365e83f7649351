"""The header of a table over an angle: names, units and whose angle it is, in the words of engineers."""

from typing import NamedTuple

from .units import UnitError, to_unit

# Longer texts are no unit.
LONGEST_UNIT = 30
# Units as tables have them, without case and marks of plural; each with pint's name.
ANGLE_UNITS = {
    **dict.fromkeys(("deg", "degs", "degree", "degrees", "°", "º", "˚", "grd", "grader"), "deg"),
    **dict.fromkeys(
        ("grad", "degré", "degrés", "degre", "degres", "grado", "grados", "gradi", "graus"), "deg"
    ),
    **dict.fromkeys(("rad", "radian", "radians"), "rad"),
    **dict.fromkeys(("gon", "grade", "gradian", "gradians"), "grade"),
}
LENGTH_UNITS = {
    **dict.fromkeys(("mm", "millimeter", "millimeters", "millimetre", "millimetres"), "mm"),
    **dict.fromkeys(("um", "µm", "μm", "micron", "microns", "micrometer", "micrometre"), "um"),
    **dict.fromkeys(("in", "inch", "inches", "zoll", '"', "''", "″", "”"), "inch"),
    **dict.fromkeys(("thou", "mil", "mils"), "thou"),
    **dict.fromkeys(("cm", "m", "ft"), None),
}
UNITS = {**ANGLE_UNITS, **{name: unit or name for name, unit in LENGTH_UNITS.items()}}
# What names the crank, and the cam: whole words, and beginnings of words.
CRANK_WORDS = ("ca", "cad", "kw", "kwg", "crk", "degca", "cadeg", "degkw", "kwdeg", "gradkw")
# What its piston passes, and its engine: a column that says so may still have angles of the cam.
DEAD_CENTRES = ("tdc", "atdc", "btdc", "bdc", "abdc", "bbdc", "ot", "ut", "pmh")
ENGINES = ("engine", "motor", "moteur", "двигат")
CRANK_BEGINNINGS = (
    *("crank", "kurbel", "vilebrequin", "manivelle", "manovell", "cigüeñal", "cigueñal", "cigueñ", "ciguen"),
    *("cambota", "virabrequim", "manivela", "krukas", "krukhoek", "vevaxel", "vevvinkel", "veiv", "krumtap"),
    *("kampi", "krank", "korb", "wału", "klik", "колен", "крив", "クランク", "曲轴", "曲軸", "크랭크"),
)
CAM_WORDS = (
    "cam", "cams", "degcam", "nw", "came", "cames", "camme", "leva", "levas", "nok", "kam",
    "カム", "凸轮", "凸輪", "캠",
)  # fmt: skip
CAM_BEGINNINGS = (
    "camsh", "camang", "camdeg", "nocken", "nokken", "kamaks", "kamvink", "knast", "krzywk", "vačk", "кулач",
)  # fmt: skip
BRACKETS = {"[": "]", "(": ")", "{": "}", "<": ">"}
GERMAN = ("winkel", "hub", "kurbel", "nocken", "ventil", "drehwinkel", "motorwinkel")
ANGLE_NAMES = (
    "angle", "winkel", "degree", "deg", "°", "grad", "theta", "phi", "φ", "θ", "ángulo", "angulo", "angolo",
    "hoek", "vinkel", "kąt", "угол", "rotation", "position", "drehwinkel",
)  # fmt: skip


class Column(NamedTuple):
    """A column's header as written, its name, and its unit; None if it has none."""

    written: str
    name: str
    unit: str | None

    @property
    def words(self) -> list[str]:
        """The words of name and unit, in small letters."""
        text = f"{self.name} {self.unit or ''}".casefold().replace("º", " ")
        return "".join(c if c.isalnum() else " " for c in text).split()


def split_column(written: str) -> Column:
    """The name and unit of "lift [mm]", "lift (mm)", "lift / mm", "lift in mm", "lift_mm" or "lift: mm"."""
    text = written.strip()
    if len(text) > 1 and text[0] == text[-1] == '"':
        text = text[1:-1].replace('""', '"').strip()
    opened = min((i for i in map(text.find, BRACKETS) if i >= 0), default=-1)
    if opened >= 0:
        closed = text.find(BRACKETS[text[opened]], opened)
        unit = " ".join(text[opened + 1 : closed].split()) if closed >= 0 else ""
        return Column(written.strip(), text[:opened].strip(), unit or None)
    name, slash, unit = text.partition("/")
    if slash and unit.strip():
        return Column(written.strip(), name.strip(), " ".join(unit.split()))
    begins = max(map(text.rfind, " _,:"))
    if begins > 0 and strip_shaft(text[begins + 1 :]) in UNITS:
        return Column(written.strip(), text[:begins].strip(" _:"), text[begins + 1 :])
    return Column(written.strip(), text, None)


def strip_shaft(unit: str) -> str:
    """The unit in small letters without whose angle it is: "deg" of "deg CA", "° KW" and "°CA"."""
    words = unit.casefold().replace("º", "°").replace("°", "° ").replace(".", " ").replace("-", " ").split()
    left = [word for word in words if not (_is_crank(word) or _is_weak(word) or _is_cam(word))]
    if not left and words:
        return "deg"  # "CAD", "crank": no length
    return " ".join(left)


def _is_cam(word: str) -> bool:
    return word in CAM_WORDS or word.startswith(CAM_BEGINNINGS)


def _is_weak(word: str) -> bool:
    """Whether the word says that an angle is the crank's unless another names the cam."""
    return word in DEAD_CENTRES or word.startswith(ENGINES)


def _is_crank(word: str) -> bool:
    return word in CRANK_WORDS or word.startswith(CRANK_BEGINNINGS)


def find_crank_word(column: Column) -> str:
    """The word of a column that says that its angle is the crank's; "" if none does. UnitError if another
    says that it is the cam's."""
    said = [word for word in column.words if _is_crank(word)]
    if said and names_cam(column):
        raise UnitError(
            f"{column.written!r} names the cam and the crank: name the one whose angles they are, 'cam angle "
            "[deg]' or 'crank angle [deg]'"
        )
    weak = () if names_cam(column) else filter(_is_weak, column.words)
    return next(iter([*said, *weak]), "")


def names_cam(column: Column) -> bool:
    """Whether the column says that its angle is the cam's."""
    return any(map(_is_cam, column.words))


def names_angle(column: Column) -> bool:
    """Whether the name, without a unit, is that of an angle."""
    known = any(word.startswith(ANGLE_NAMES) for word in column.words)
    return known or bool(find_crank_word(column)) or names_cam(column)


def names_no_shaft(column: Column) -> bool:
    """Whether it has words that are neither those of any angle nor known units."""
    return not all(word in ANGLE_UNITS or word.startswith(ANGLE_NAMES) for word in column.words)


def find_factor(written: str, unit: str) -> float:
    """What a written unit is in `unit`; UnitError that names it."""
    written = written.strip().removesuffix(".")
    known = strip_shaft(written) if unit == "rad" else " ".join(written.casefold().split())
    if len(known) > LONGEST_UNIT:
        raise UnitError(f"{written[:LONGEST_UNIT]!r}... is an unknown unit")
    tried = (UNITS[known],) if known in UNITS else (written, known)
    faults = []
    for name in tried:
        try:
            return to_unit(f"1 {name}", unit)
        except UnitError as error:
            faults.append(str(error).removeprefix(f"'1 {name}': "))
    raise UnitError(faults[0])


def is_doubtful_grad(column: Column, others: list[Column]) -> bool:
    """Whether "grad" may be the gon: no word of the header is German."""
    if column.unit is None or strip_shaft(column.unit) != "grad":
        return False
    return not any(word.startswith(GERMAN) for other in others for word in other.words)

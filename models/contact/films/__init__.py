"""Film thickness formulas for line contacts. To add one: a file with `film` (a kernel), listed here.

Each kernel is film(load, velocity, radius, length, compliance, viscosity, pressure_viscosity) -> m, for a
positive load and reduced radius and an entraining speed from zero on. A film is finite and not negative.
"""

from typing import Any

from ...compile.kernel import kernel
from . import kushwaha, moes_venner, power_laws


@kernel
def no_film(
    load: float, velocity: float, radius: float, length: float, compliance: float,
    viscosity: float, pressure_viscosity: float,
) -> float:  # fmt: skip
    """h = 0: a dry Hertzian contact."""
    return 0.0


# The order is the number of the film model in FMUs: append only.
FILMS: dict[str, Any] = {
    "kushwaha": kushwaha.film,
    "kushwaha_negative": kushwaha.negative_film,
    "dowson_higginson": power_laws.dowson_higginson,
    "dowson_toyoda": power_laws.dowson_toyoda,
    "pan_hamrock_minimum": power_laws.pan_hamrock_minimum,
    "pan_hamrock_central": power_laws.pan_hamrock_central,
    "moes_venner": moes_venner.film,
    "dry": no_film,
}


# The one formula whose film grows with its load: it can feed vibrations of the contact.
GROWING = "kushwaha"


def _choose(number: int, film: Any, others: Any) -> Any:
    @kernel
    def selected_film(
        model: float, load: float, velocity: float, radius: float, length: float, compliance: float,
        viscosity: float, pressure_viscosity: float,
    ) -> float:  # fmt: skip
        if model == number:
            return film(load, velocity, radius, length, compliance, viscosity, pressure_viscosity)
        return others(model, load, velocity, radius, length, compliance, viscosity, pressure_viscosity)

    return selected_film


@kernel
def _unknown(
    model: float, load: float, velocity: float, radius: float, length: float, compliance: float,
    viscosity: float, pressure_viscosity: float,
) -> float:  # fmt: skip
    return 0.0


def _film_by_number() -> Any:
    film = _unknown
    for number, one in reversed(list(enumerate(FILMS.values()))):
        film = _choose(number, one, film)
    return film


# film_by_number(model, load, velocity, radius, length, compliance, viscosity, pressure_viscosity) -> m
film_by_number = _film_by_number()

"""Film thickness formulas for line contacts. To add one: a file with `film` (a kernel), listed here.

Each kernel is film(load, at) -> m, for a positive load and any entraining velocity, of which the size counts.
A film is finite and not negative.
"""

from typing import Any

from ...compile.kernel import kernel
from . import kushwaha, moes_venner, power_laws
from .groups import Conditions


@kernel
def no_film(load: float, at: Conditions) -> float:
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
    def selected_film(model: float, load: float, at: Conditions) -> float:
        if model == number:
            return film(load, at)
        return others(model, load, at)

    return selected_film


@kernel
def _unknown(model: float, load: float, at: Conditions) -> float:
    return 0.0


def _film_by_number() -> Any:
    film = _unknown
    for number, one in reversed(list(enumerate(FILMS.values()))):
        film = _choose(number, one, film)
    return film


# film_by_number(model, load, at) -> m
film_by_number = _film_by_number()

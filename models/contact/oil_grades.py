"""Grades of oils. A grade is a band of viscosity; the oil here is a typical one inside it.

Engine oils: bands of SAE J300 (2021), and numbers as makers' data sheets have them, rounded. Sheets of the
same grade differ by 10 % in viscosity. Industrial oils: ISO 3448, which allows 10 % about the number of the
grade at 40 degC; the viscosity at 100 degC is that of viscosity index 95 (ISO 2909, ASTM D2270), of mineral
oil.
"""

from typing import NamedTuple

from .oils import Oil


class Band(NamedTuple):
    """What SAE J300 asks of the second number of a grade.

    Kinematic viscosity at 100 degC from `low` to below `high` (m2/s); viscosity of the sheared oil at
    150 degC of at least `sheared` (Pa s).
    """

    low: float
    high: float
    sheared: float


SAE_J300 = {
    "16": Band(6.1e-6, 8.2e-6, 2.3e-3),
    "20": Band(6.9e-6, 9.3e-6, 2.6e-3),
    "30": Band(9.3e-6, 12.5e-6, 2.9e-3),
    "40": Band(12.5e-6, 16.3e-6, 3.5e-3),
    "50": Band(16.3e-6, 21.9e-6, 3.7e-3),
}
# Of grade 40 behind 15W and above, and alone.
SHEARED_40 = 3.7e-3
ISO_3448_SHARE = 0.1

ENGINE_OILS = {
    "SAE 0W-16": Oil(36e-6, 7.3e-6, 843.0),
    "SAE 0W-20": Oil(44e-6, 8.4e-6, 845.0),
    "SAE 0W-30": Oil(63e-6, 11.5e-6, 845.0),
    "SAE 0W-40": Oil(75e-6, 13.5e-6, 850.0),
    "SAE 5W-20": Oil(49e-6, 8.6e-6, 855.0),
    "SAE 5W-30": Oil(63e-6, 11.0e-6, 855.0),
    "SAE 5W-40": Oil(84e-6, 14.0e-6, 855.0),
    "SAE 10W-30": Oil(68e-6, 10.6e-6, 870.0),
    "SAE 10W-40": Oil(95e-6, 14.3e-6, 870.0),
    "SAE 15W-40": Oil(108e-6, 14.6e-6, 880.0),
    "SAE 15W-50": Oil(125e-6, 17.4e-6, 875.0),
    "SAE 20W-50": Oil(160e-6, 18.3e-6, 885.0),
    "SAE 30": Oil(93e-6, 10.9e-6, 887.0),
    "SAE 40": Oil(140e-6, 14.4e-6, 893.0),
    "SAE 50": Oil(205e-6, 19.0e-6, 897.0),
}
INDUSTRIAL_OILS = {
    "ISO VG 32": Oil(32e-6, 5.29e-6, 870.0),
    "ISO VG 46": Oil(46e-6, 6.64e-6, 875.0),
    "ISO VG 68": Oil(68e-6, 8.53e-6, 880.0),
    "ISO VG 100": Oil(100e-6, 11.07e-6, 885.0),
    "ISO VG 150": Oil(150e-6, 14.54e-6, 890.0),
    "ISO VG 220": Oil(220e-6, 18.75e-6, 893.0),
    "ISO VG 320": Oil(320e-6, 23.95e-6, 897.0),
    "ISO VG 460": Oil(460e-6, 30.34e-6, 900.0),
}
GRADES = {**ENGINE_OILS, **INDUSTRIAL_OILS}


def describe_grade(name: str) -> str:
    """What the grade allows, and what its typical oil has."""
    oil = GRADES[name]
    if name in INDUSTRIAL_OILS:
        allowed = f"+-{100.0 * ISO_3448_SHARE:g} % of {1e6 * oil.viscosity_40:g} mm2/s at 40 degC"
        return f"typical of a grade that allows {allowed}"
    band = SAE_J300[name.replace("-", " ").split()[-1]]
    allowed = f"{1e6 * band.low:g} to {1e6 * band.high:g} mm2/s at 100 degC"
    return f"typical, {1e6 * oil.viscosity_100:g} mm2/s, of a grade that allows {allowed}"

"""Speed of the slider-crank's core."""

from __future__ import annotations

from collections.abc import Iterator

from benchmarks import exponent_map
from benchmarks import slider_crank as benchmark

from .table import Row


def rows() -> Iterator[Row]:
    found = dict(benchmark.rows())
    words = {name.removeprefix("slider-crank: "): value for name, value in found.items()}
    ratio = float(words["core / fixed step"])
    yield Row(
        "crank cycles per second on one core, chaotic case (.05, .01): at least 20 times the fixed step",
        f"{words['core, revolutions/s']} against {words['fixed step, revolutions/s']}: {ratio:.1f} times",
        command="python -m benchmarks slider_crank",
        short="" if ratio >= 20.0 else "below 20.",
    )
    yield Row(
        "error per impact below 1e-10 where the baseline has its own",
        f"core {words['core, largest error per impact']}; baseline "
        f"{words['fixed step, largest error per impact']}",
        command="python -m benchmarks slider_crank",
    )
    every = exponent_map.rows()
    maps = ", ".join(f"{name.partition(':')[0].partition(', ')[2]}: {value}" for name, value in every)
    yield Row(
        "a 200 x 200 map of the largest exponent, 1000 cycles a point, in minutes on two cores",
        f"from 20 x 20 points, times 100: {maps}",
        ("models/test_maps.py::test_maps_do_not_depend_on_the_number_of_workers",),
        command="python -m benchmarks exponent_map",
    )
    yield Row(
        "with a CUDA device the same kernels run one trajectory a thread; results agree with the CPU",
        "in numba's simulator: the same states and exponents over four revolutions (1e-10)",
        ("models/test_gpu.py::test_simulated_device_agrees_with_the_processor",),
        short="not run on a device: none was at hand. Both kernels compile to device code for compute "
        "capability 9.0 with numba-cuda 0.30.",
    )

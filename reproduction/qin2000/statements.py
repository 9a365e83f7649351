"""Every statement of the source that tells how valve trains behave or are modelled, in its order."""

from ..statement import Claim, is_near
from . import quantities as q
from .runs import Runs

# fmt: off
CLAIMS: tuple[Claim[Runs], ...] = (
    Claim("elastic", "Introduction",
        "The valve's motion deviates from that of the kinematic analysis, by inertia and elastic vibration",
        q.compare_with_kinematics,
        "largest deviation {low_deviation:µ.1f} µm at 1000 r/min, {rated_deviation:µ.1f} µm at "
        "{rated_rpm:.0f} r/min, of 10 mm lift", lambda v: v.rated_deviation > v.low_deviation > 1e-6),
    Claim("separation", "Introduction", "Thus the separation in the mechanism will occur",
        q.compare_with_kinematics,
        "contact kept at {rated_rpm:.0f} r/min with {rated_load:.0f} N or more; none in {high_lost:.0f%} of "
        "the turn at {high_rpm:.0f} r/min", lambda v: v.rated_load > 0.0 and v.high_lost > 0.0),
    Claim("worse", "Introduction", "Separation will make its working conditions worse", q.compare_blow,
        "blows of {largest:.0f} N on the cam at 3000 r/min; a rigid train that never parts would need "
        "{rigid_least:.0f} to {rigid_largest:.0f} N",
        lambda v: v.rigid_least < 0.0 and v.largest > v.rigid_largest),
    Claim("speed", "Introduction", "With the speed these dynamics problems become more and more significant",
        q.compare_with_kinematics,
        "deviation {low_deviation:µ.1f}, {rated_deviation:µ.1f} and {high_deviation:µ.0f} µm at 1000, "
        "{rated_rpm:.0f} and {high_rpm:.0f} r/min",
        lambda v: v.low_deviation < v.rated_deviation < v.high_deviation),
    Claim("modes", "1.1", "A part's deformation can be approximated with a linear combination of mode shapes",
        q.superpose_modes,
        "twist of a shaft by a torque at its free end: {lowest:.1f%} with 1, 2 and 3 modes, {all:.6f%} with "
        "the shape under this torque as well",
        lambda v: v.lowest[0] < v.lowest[1] < v.lowest[2] < 1.0 and is_near(v.all, 1.0, 1e-9),
        "the lowest modes alone converge slowly"),
    Claim("effective", "1.1", "The finite segment method is a simple and effective way for slender parts",
        q.refine_pushrod,
        "`qin2000-train` at 1600 r/min, pushrod of 1, 2 and 4 segments against twice as many: the valve's "
        "acceleration changes by {accelerations:.2f} m/s² of {acceleration:.0f} m/s², the cam's load by "
        "{loads:.2f} N",
        lambda v: v.accelerations[2] < v.accelerations[0] / 12.0
        and v.accelerations[2] < 1e-3 * v.acceleration),
    Claim("segment-rate", "1.1, (1)", "A spring at both ends of each rod segment has k = 2AE/L",
        q.compute_rods,
        "static rate {rates:.9f} of A E/L with 2, 4 and 8 segments; first frequency off by "
        "{frequency_errors:.2f%}",
        lambda v: all(is_near(rate, 1.0, 1e-9) for rate in v.rates)
        and abs(v.frequency_errors[2]) < abs(v.frequency_errors[0]) / 12.0,
        "exact in statics for any number, of second order in frequency"),
    Claim("connector-place", "1.1, (2)", "The flexible connector of a beam is on each end of the segment",
        q.compute_beams,
        "first frequency of a free beam of 2, 4 and 8 segments off by {two:.2f%} with two connectors between "
        "neighbours, by {one:.2f%} with one",
        lambda v: abs(v.two[2]) < abs(v.two[0]) / 12.0,
        "one K(L) between the centres of neighbours is right: (2) has no factor 2 as (1)"),
    Claim("connector-law", "1.1, (2)", "Q = −Kδ − Cδ', with K and C symmetric", q.compute_connector,
        "K of the beam element differs from its transpose by {asymmetry:.1g} of its largest entry",
        lambda v: v.asymmetry < 1e-15),
    Claim("timoshenko", "1.1", "K of Timoshenko's theory, with P = 12 E I A_y/(G A L²)", q.compute_connector,
        "flexibility of a tip at 100 mm, 20 mm thick: {printed_flexibility:.6g} m/N as printed, "
        "{beam_flexibility:.6g} m/N of the beam element",
        lambda v: is_near(v.printed_flexibility, v.beam_flexibility, 1e-9)),
    Claim("main-forces", "1.2", "The main forces are that of the valve spring and the gas pressure",
        q.compare_forces,
        "`qin2000-train` at 1600 r/min: spring up to {spring:.0f} N, friction of a contact up to "
        "{friction:.0f} N; inertia changes the cam's load by up to {inertia:.0f} N",
        lambda v: v.friction < 0.1 * v.spring,
        "met if friction stays below a tenth of the spring; inertia is no applied force"),
    Claim("gas", "1.2", "The gas pressure is usually ignored because of its small effect",
        q.compare_gas,
        "valves of 30 mm at full load, largest load of the cam: exhaust {exhaust:.0f} N, intake "
        "{intake:.0f} N, without gas {without_gas:.0f} N",
        lambda v: max(v.exhaust, v.intake) < 1.05 * v.without_gas,
        "by the largest load, on the flank; an exhaust valve opens against {gas:.0f} N of gas"),
)
# fmt: on

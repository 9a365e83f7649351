"""Every statement of the source that tells how valve trains behave or are modelled, in its order."""

from __future__ import annotations

from ..statement import Claim, Verdict, is_near
from . import quantities as q
from .runs import Runs

UNKNOWN = "the paper prints no geometry, mass or stiffness of the example"

# fmt: off
CLAIMS: tuple[Claim[Runs], ...] = (
    Claim("elastic", "Introduction",
        "The valve's motion deviates from that of the kinematic analysis, by inertia and elastic vibration",
        q.compare_with_kinematics,
        "largest deviation {low_deviation:µ.1f} µm at 1000 r/min, {rated_deviation:µ.1f} µm at "
        "{rated_rpm:.0f} r/min, of 10 mm lift", lambda v: v.rated_deviation > v.low_deviation > 1e-6),
    Claim("separation", "Introduction", "Thus the separation in the mechanism will occur",
        q.compare_with_kinematics,
        "contact kept at {rated_rpm:.0f} r/min with {rated_load:.0f} N or more; none in {high_lost:.0%} of "
        "the turn at {high_rpm:.0f} r/min", lambda v: v.rated_load > 0.0 and v.high_lost > 0.0),
    Claim("speed", "Introduction", "With the speed these dynamics problems become more and more significant",
        q.compare_with_kinematics,
        "deviation {low_deviation:µ.1f}, {rated_deviation:µ.1f} and {high_deviation:µ.0f} µm at 1000, "
        "{rated_rpm:.0f} and {high_rpm:.0f} r/min",
        lambda v: v.low_deviation < v.rated_deviation < v.high_deviation),
    Claim("mass-models", "Introduction",
        "The parameters of single- and multi-mass models must come from experiments or other analyses",
        q.compute_rods, "those of a rod of segments follow from its drawing: {rates:.12f} of A E/L",
        Verdict.UNCHECKED, "a statement on the practice of its time"),
    Claim("two-stages", "1", "The whole valve train's model is for the torsion dynamics of the camshaft",
        q.count_train,
        "`pushrod-engine`: {trains} trains with rods of {segments} segments on {shafts} shaft with "
        "{torsion_modes} modes of torsion", lambda v: v.trains == 8 and v.shafts == 1),
    Claim("segment-rate", "1.1, (1)", "A spring at both ends of each rod segment has k = 2AE/L",
        q.compute_rods,
        "static rate {rates:.9f} of A E/L with 2, 4 and 8 segments; first frequency off by "
        "{frequency_errors:.2%}",
        lambda v: all(is_near(rate, 1.0, 1e-9) for rate in v.rates)
        and abs(v.frequency_errors[2]) < abs(v.frequency_errors[0]) / 12.0,
        "exact in statics for any number, of second order in frequency"),
    Claim("connector-place", "1.1, (2)", "The flexible connector of a beam is on each end of the segment",
        q.compute_connector,
        "two of them in series between neighbours halve the stiffness: {literal_share:.4f} of the frequency",
        Verdict.CANNOT, "one K(L) between the centres of neighbours is right: (2) has no factor 2 as (1)"),
    Claim("connector-law", "1.1, (2)", "Q = −Kδ − Cδ', with K and C symmetric", q.compute_connector,
        "K differs from its transpose by {asymmetry:.0g}", lambda v: v.asymmetry == 0.0),
    Claim("timoshenko", "1.1", "K of Timoshenko's theory, with P = 12 E I A_y/(G A L²)", q.compute_connector,
        "flexibility of a tip at 100 mm, 20 mm thick: {printed_flexibility:.6g} m/N as printed, "
        "{beam_flexibility:.6g} m/N of the beam element",
        lambda v: is_near(v.printed_flexibility, v.beam_flexibility, 1e-9)),
    Claim("gas", "1.2", "The gas pressure is usually ignored because of its small effect",
        q.compare_gas,
        "an exhaust valve of 30 mm at full load: largest load of the cam {with_gas:.0f} N with gas, "
        "{without_gas:.0f} N without", lambda v: v.times < 1.05,
        "not of an exhaust valve, which opens against the pressure that is left"),
    Claim("springs", "1.2", "The valve spring may be linear, non-linear or multi-mass", q.list_springs,
        "`valve_spring` has {masses} coil masses or more, `coil_spring` closing coils",
        lambda v: v.masses >= 1),
    Claim("fig-2", "3, Fig. 2", "Displacement, velocity and acceleration of the valve at low and high speed",
        q.compare_with_kinematics, "of `pushrod-train`: figure above", Verdict.UNCHECKED, UNKNOWN),
    Claim("figs-3-4", "3, Figs 3 and 4", "Contact forces and stresses of cam-tappet and rocker-valve",
        q.compute_stresses,
        "`pushrod-train` at 1600 r/min: {cam_load:.0f} N and {cam_peak:G.3f} GPa, {valve_load:.0f} N and "
        "{valve_peak:G.3f} GPa", Verdict.UNCHECKED, UNKNOWN),
    Claim("no-separation", "3", "There is no separation in the mechanism", q.compare_with_kinematics,
        "least load of `pushrod-train` {rated_load:.0f} N at {rated_rpm:.0f} r/min", Verdict.UNCHECKED,
        UNKNOWN),
    Claim("permissible", "3", "Landing velocity and contact stresses are below the permissible values",
        q.compute_stresses, "at most {cam_peak:G.3f} GPa in `pushrod-train`", Verdict.UNCHECKED,
        "the paper states neither the values nor the permissible ones"),
    Claim("ample-factor", "3", "The ample factor of the valve lift is 0.502", q.compute_cams,
        "cams of this project by law: {laws}", Verdict.UNCHECKED,
        "the law is not printed; 0.502 is between those of usual laws, 0.5 without a dwell"),
    Claim("lubrication", "3", "The lubrication characteristic's slope at its zero is below 3 mm/deg",
        q.compute_cams,
        "{least_slope:.2f} to {largest_slope:.2f} mm/deg by law (base circle 20 mm, lift 8 mm); that of the "
        "harmonic law jumps",
        lambda v: v.own_slope < 3.0,
        "the characteristic is read as R0 + s + 2 s'', which has this unit; it is not defined there"),
    Claim("judgement", "3", "These results show that lubrication is not very good", q.compute_cams,
        "slope of the default cam {own_slope:.2f} mm/deg", Verdict.UNCHECKED,
        "a limit for the slope is not given"),
)
# fmt: on

"""F's statements on its equations, walls, forces and motions, in its order; misprints are left out."""

from functools import partial

from models.slider_crank.motions.classification import CHAOTIC, PERIODIC, TRANSIENT_CHAOS
from models.slider_crank.motions.regions import TURN

from ..statement import Claim, Verdict, is_near, is_rising
from . import derivation, force, impacts, motions
from .both_forms import BothForms, of_kind, of_symmetry
from .runs import HIGH_DAMPINGS, LOW_DAMPINGS, Case, Runs, list_cases

# Central differences in `lagrange` leave 1e-9.
ROUNDING = 1e-7
# Read from a printed graph, an angle is good to about so much (rad).
GRAPH = 0.02
# What "approximately" may be about an angle that F names by 0, pi and 2 pi (rad).
ABOUT = 0.15
# F's intervals are "typically small": below this part of a revolution.
SMALL = 0.05
# What F says of half a turn.
EVEN = (
    "false: f(τ) has the term in sin 2τ, which does not change its sign in half a turn. What holds at λ = 0, "
    "for every ρ, is f_u(−θ) = f_l(θ)"
)
# Two states of one motion differ at the print's resolution if by more than this part of their range.
PRINTED = 0.005
UNKNOWN_START = (
    "F's start is not known: from some starts the transient is shorter than the 30 cycles that F leaves out"
)
TRANSIENT = ("exhibits transient chaos", TRANSIENT_CHAOS, "")
SUSTAINED = ("exhibits sustained chaos", CHAOTIC, "")
# F's 3 x 3 matrix of Figs 4.6 to 4.14.
MATRIX_KINDS = (
    TRANSIENT, TRANSIENT, SUSTAINED,
    SUSTAINED, ("is periodic without a chaotic transient", PERIODIC, UNKNOWN_START), SUSTAINED,
    TRANSIENT, SUSTAINED, SUSTAINED,
)  # fmt: skip

# fmt: off
CLAIMS: tuple[Claim[Runs], ...] = (
    BothForms("three-types", "Abstract", "Three types of response: chaotic, transient chaos, periodic",
        motions.count_kinds, "of the 18 pairs (λ, ρ) at e = 0.9: {each}", lambda v: v.least > 0),
    BothForms("chaos-prevails", "Abstract, 5",
        "Chaos is prevalent at high speed or low friction with nearly ideal impacts; periodic motion at low "
        "speed or low e", motions.count_chaotic,
        "chaotic: {fast} of 9 at λ ≤ 0.075, e = 0.9; {slow} of 9 at λ ≥ 0.15; {soft} of 9 at e = 0.5",
        lambda v: v.fast > max(9 / 2, v.slow, v.soft),
        "prevalent: more than half of the cases. As published λ = 0.15 and 0.20 are as chaotic as small λ"),
    Claim("gravity", "2.1", "Gravity may be ignored when the crank speed is sufficiently large",
        derivation.compute_engine,
        "g/(rΩ²) = {gravity_slow:.3f} at 600 r/min, {gravity_fast:.4f} at 3000 r/min",
        lambda v: v.gravity_fast < 0.01),
    Claim("rod-rotation", "2.2, (2.1)", "The angular velocity of the connecting rod is φ̇ + ψ̇",
        derivation.compute_rates,
        "by F's own displacements the rod turns with {seen:.4f} where φ' = {phi_rate:.4f} and ψ' = 0.2: φ' "
        "− ψ', not φ' + ψ' = {wrong:.4f}", Verdict.CANNOT,
        "the rod's angle is φ − ψ. The error puts −β for +β into f(τ), a factor of (ξ³ − ξ) sin τ/Λ³ of "
        "{published:.4f} for {corrected:.4f}: the whole difference between the two forms"),
    Claim("friction-moment", "2.2, (2.6)",
        "The friction moment is −c₂(−θ̇ − φ̇ + ψ̇), proportional to the rate of the rod relative to the "
        "crank", derivation.compute_rates,
        "relative rate from the positions {relative:.6f}, θ' + φ' − ψ' = {stated:.6f}",
        lambda v: abs(v.relative - v.stated) < ROUNDING,
        "it uses the rod's rate φ̇ − ψ̇, against (2.1)"),
    Claim("equation-2-10", "(2.10)", "The dimensionless equation of motion follows by Lagrange's method",
        derivation.compare_equations,
        "differs by {own:.0e} from Lagrange's equation of F's energy with φ' + ψ', by up to {rod:.3f} from "
        "that with the rod's rate φ' − ψ'", lambda v: v.own < ROUNDING,
        "a right derivation from a wrong energy"),
    Claim("equation-2-13", "(2.13)",
        "Linear in ψ the equation is a ψ'' + b ψ' + c(τ) ψ = f(τ), with these a, b, c, f",
        derivation.compare_equations,
        "differs from (2.10) by up to {small:.1e} at ψ = 0.01 and {large:.1e} at 0.02: ratio {growth:.2f}, "
        "second order", lambda v: 3.8 < v.growth < 4.2, "a right linearization of the published equation"),
    Claim("speed-in-lambda", "2.4", "Only λ depends on the crank speed: to vary λ is to vary the speed",
        derivation.compare_equations,
        "with c₂ ∝ Ω the moments over Ω² at 10 and 300 rad/s are the same to {speed:.0e}",
        lambda v: v.speed < 1e-12,
        "if e does not depend on the impact velocity"),
    Claim("wall-angles", "(2.14), (A.4)", "For |ψ| ≪ 1, ψ_max = ρ/√(1 − ξ² sin²τ)", derivation.check_walls,
        "off by at most {off:.2f%} of ρ from sin(φ − ψ) = sin φ − ρ at ρ = 0.010, 0.015, 0.020",
        lambda v: v.off[2] < 0.01 and is_near(v.off[2] / v.off[0], 2.0, 0.025)),
    Claim("impact-rule", "(2.16), (2.17)",
        "ẏ_s after = −e ẏ_s before gives ψ̇ after = (1+e) ξ² sin τ cos τ/Λ² ψ − e ψ̇ before",
        derivation.check_walls,
        "velocities relative to the wall after and before are in the ratio −e to {fault:.0e}",
        lambda v: v.fault < 1e-15),
    Claim("when-it-slides", "2.6",
        "Sliding occurs when the friction is large or the coefficient of restitution small",
        derivation.measure_sliding,
        "share of the time in which it slides: (0.05, 0.01): {plain:.0f%}, λ = 0.25: {damped:.0f%}, e = "
        "0.5: {soft:.0f%}", lambda v: v.plain == 0.0 < min(v.damped, v.soft)),
    BothForms("four-regions", "2.6",
        "There are four kinds of crank angles: sliding on the upper wall only, lower only, either, neither",
        force.divide_turn, "rad of a turn at (0.1, 0.01): {each}", lambda v: v.least > 0.0),
    Claim("equation-2-27", "(2.27), (2.29)",
        "… − β(φ'' − ψ'') = −f_u cos(φ−ψ) + … in (2.27), … + β(φ'' + ψ'') … in (2.29)",
        derivation.compare_equations,
        "(2.27) differs by up to {own_2_27:.3f} from Lagrange's equation of F's energy (2.5) and by "
        "{rod_2_27:.0e} from that with the rod's right rate φ' − ψ'", Verdict.CANNOT,
        "(2.27) is right, printed once and not used: all figures follow from (2.10) and (2.29)"),
    of_symmetry("symmetry-i", "ρ = 0, λ = 0: (i) f_u = −f_l", 0.0, 0.0),
    of_symmetry("symmetry-ii", "ρ = 0, λ = 0: (ii) f_u(θ + π) = −f_u(θ)", 0.0, 0.0, reason=EVEN),
    of_symmetry("symmetry-i-damped", "ρ = 0, λ ≠ 0: (i) holds", 0.05, 0.0),
    of_symmetry("symmetry-ii-damped", "ρ = 0, λ ≠ 0: (ii) is broken", 0.05, 0.0, True, "also without λ"),
    of_symmetry("symmetry-i-gap", "ρ ≠ 0, λ = 0: (i) is broken", 0.0, 0.02, True),
    of_symmetry("symmetry-ii-gap", "ρ ≠ 0, λ = 0: (ii) holds", 0.0, 0.02, reason=EVEN),
    BothForms("figure-2-4", "2.6, Fig. 2.4",
        "(0.01, 0.01): the forces change direction at two crank angles; sliding on the upper wall from "
        "about 0 to π, on the lower from π to 2π", force.find_changes_of_sign,
        "{upper_changes} changes of sign on the upper wall, {lower_changes} on the lower; may slide: upper "
        "wall {upper}, lower {lower}", lambda v: 0.0 < v.off < ABOUT,
        "with the right sign the wall force changes side four times a revolution at high speed"),
    BothForms("longer-upper", "2.6, Figs. 2.4-2.6",
        "As λ increases, the force on the upper wall increases and its sliding region is extended (ρ = 0.01)",
        force.compare_dampings,
        "rad of a turn at λ = 0.01, 0.1, 0.25: {spans:.3f}; the force grows at {where}",
        lambda v: v.grows and v.spans[0] < v.spans[1] <= v.spans[2]),
    BothForms("asymmetry", "2.6", "f_u = −f_l only for ρ = 0; f_u + f_l deviates from zero as ρ increases",
        force.compare_gaps, "largest |f_u + f_l| at ρ = 0, 0.01, 0.02: {sums:.5f}",
        lambda v: v.sums[0] < 1e-12 < v.sums[1] < v.sums[2]),
    BothForms("figure-2-7", "2.6, Fig. 2.7",
        "λ = 0.267, ρ = 0.02: upper wall over the entire cycle, and the lower too for 4.96 < θ < 5.14",
        force.find_holding_intervals, "upper wall {upper}, lower wall {lower}",
        lambda v: max(abs(v.begin - 4.96), abs(v.end - 5.14)) < GRAPH and not v.upper_changes,
        "as read from a graph; (2.29) not linearized, at F's linear walls, gives "
        "{mixed[0]:.3f}-{mixed[1]:.3f}, nearer to the printed numbers"),
    BothForms("near-crossings", "2.6, Fig. 2.8",
        "At the crossing that continues θ = π either wall can hold the roller, at that of 2π neither, for "
        "all (λ, ρ) with crossings; the intervals are typically small",
        force.measure_crossings, "{words}", lambda v: v.least > 0.0 and v.most < SMALL * TURN),
    BothForms("figure-2-8", "2.6, Fig. 2.8",
        "(0.1, 0.01): first an interval with sliding on either wall, then one with sliding on neither",
        force.find_crossings, "{pairs} ({kinds})", lambda v: v.kinds == ["either", "neither"]),
    BothForms("figure-2-9", "2.6, Fig. 2.9",
        "λ = 0.35: the roller may slide along the upper wall throughout the cycle and will never release",
        force.count_releases, "least force {least:.4f}; {releases} releases in 100 cycles",
        lambda v: v.least > 0.0 and v.releases == 0, "F does not give the figure's ρ; 0.01 taken"),
    BothForms("figure-2-10", "2.6, Fig. 2.10",
        "Regions: I for Figs. 2.4, 2.5, 2.6; II for Fig. 2.7; III for Fig. 2.9",
        force.assign_regions, "{each}", lambda v: v.right),
    BothForms("thresholds", "2.6, Fig. 2.10", "Region II lies between I and III and grows with ρ",
        force.find_thresholds,
        "λ = {zero:.5f} as ρ → 0; at ρ = 0.02 I ends at {first:.5f} and III begins at {second:.5f}",
        lambda v: v.first < v.zero < v.second,
        "with the right sign less than half of the friction holds the roller on the upper wall for good"),
    Claim("ratios", "4.1", "The engine's masses and lengths give ξ = 0.3030, α = 1.9000, β = 0.4719",
        derivation.compute_engine, "ξ = {xi:.4f}, α = {alpha:.4f}, β = {beta:.4f}", lambda v: v.good,
        "β within what the printed digits of I_r and M leave open"),
    Claim("uniform-rod", "2.2, 4.1", "The connecting rod is uniform, with β = 0.4719",
        derivation.compute_engine,
        "a uniform rod has β = α/12 = {uniform:.4f}; 0.4719 is {of_uniform:.2f} times that and "
        "{of_most:.1f%} of α/4 = {most:.4f}, all of its mass at its ends", Verdict.CANNOT,
        "no rod has that; kept, as all figures follow from it"),
    BothForms("no-sliding", "4.1, 4.3",
        "For small λ and e near 1 (λ ≤ 0.075, e = 0.9) no sliding is observed in the steady state",
        motions.list_unexpected_sliding, "{count} of {cases} records have sliding{recorded}{other}",
        lambda v: v.count == 0, "judged by records from the middle of the gap"),
    BothForms("with-sliding", "4.1, 4.4",
        "λ = 0.15, 0.20, 0.25 are large enough that sliding occurs in the steady state",
        motions.list_sliding, "{count} of {cases} cases slide{listed}", lambda v: v.count == v.cases,
        "with F's threshold as published {ruled} slide: {ruled_cases}. At λ = 0.15 and 0.20 what F takes "
        "for sliding is a row of small impacts, cut short by the release"),
    BothForms("kinds-in-both", "4.1",
        "All three kinds are observed with and without sliding, periodic motions more often with it",
        motions.count_kinds, "{sets}",
        lambda v: v.low_kinds == v.high_kinds == 3 and v.periodic_high > v.periodic_low,
        "by the cases of 4.3 and 4.4; what slides again and again is exactly periodic in the end"),
    BothForms("not-periodic", "4.2, Fig. 4.1",
        "(0.05, 0.01), after 25 cycles: no strict periodicity in two cycles", motions.measure_distance,
        "after 25 cycles successive cycles begin {apart:.0f%} of the range or more apart",
        lambda v: v.apart > PRINTED),
    BothForms("sensitive", "4.2, Fig. 4.3",
        "The system has a chaotic response to periodic excitation; 3000 revolutions clearly show it",
        motions.find_exponent, "{kind}: {evidence}",
        lambda v: v.exponent > 3.0 * v.error and v.kind == CHAOTIC,
        "corrected, this case is transient chaos: it slides in the end, and repeats"),
    BothForms("fractal", "4.2, Figs. 4.4, 4.5", "Two magnifications show the fractal nature of the attractor",
        motions.compute_dimension, "{words}", lambda v: 1.0 < v.dimension < 2.0),
    BothForms("matrix-kinds", "4.3", "All three types of response occur in the 3 × 3 matrix",
        motions.count_kinds, "{low}", lambda v: v.low_kinds == 3),
    *(
        of_kind(f"4.3, Fig. 4.{number}", f"{case} {words}", case, kind, reason)
        for number, case, (words, kind, reason) in zip(
            range(6, 15), list_cases(LOW_DAMPINGS), MATRIX_KINDS, strict=True)
    ),
    BothForms("uniform-if-chaotic", "Abstract, 4.3, 5",
        "Chaotic motions give quite uniform distributions of impacts, periodic ones highly localized impacts",
        impacts.measure_uniformity,
        "uniformity of the impact velocities over {bins} parts of the walls (1 even, 0 one spot): chaotic "
        "{chaotic}, others {other}", lambda v: v.least_chaotic > v.most_other,
        "of 3000 cycles, or of one period after the transient. Chaos in narrow bands, as at (0.15, 0.01), "
        "wears in spots too; corrected, long periods with slides wear as evenly as chaos"),
    BothForms("faster-with-gap", "4.3, 5",
        "As a general rule the average impact velocities increase with the gap",
        impacts.compare_gaps, "mean velocity at ρ = 0.010, 0.015, 0.020: {speeds}", lambda v: v.faster,
        "velocities of approach to the wall, over lΩ"),
    BothForms("longer-flights", "4.3, 5", "… as the free motion has a longer time to build up momentum",
        impacts.compare_gaps, "mean rad between impacts at ρ = 0.010, 0.015, 0.020: {flights}",
        lambda v: v.longer),
    BothForms("upper-harder", "4.3",
        "As expected, impact velocities are greater on the upper wall than on the lower, the more the "
        "larger λ", partial(impacts.compare_walls, dampings=LOW_DAMPINGS),
        "mean velocity on the upper wall less that on the lower, mean over ρ, at λ = 0.025, 0.05, 0.075: "
        "{differences:+.4f}; lower wall hit harder at {wrong}",
        lambda v: v.wrong == "none" and is_rising(v.differences),
        "by the mean; the upper wall has many small impacts"),
    BothForms("slight-changes", "4.3",
        "Very slight changes of the parameters render the periodic motions chaotic",
        motions.vary_gap, "(0.05, 0.015) with ρ changed by {each}",
        lambda v: v.kinds[2] != CHAOTIC and CHAOTIC in v.kinds, "very slight: up to 2 %"),
    BothForms("sliding-matrix", "4.4, Figs. 4.24-4.32",
        "The matrix λ = 0.15, 0.20, 0.25: periodic at λ = 0.25",
        motions.describe_matrix, "{each}", lambda v: v.periodic[-1] == 3),
    BothForms("more-periodic", "4.4, Figs. 4.24-4.32",
        "Periodic motions are much more prevalent as λ is increased",
        motions.describe_matrix, "periodic at λ = 0.15, 0.20, 0.25: {periodic} of 3",
        lambda v: v.periodic[-1] > v.periodic[0] and v.periodic == sorted(v.periodic),
        "as published (0.15, 0.01) looks periodic too; corrected, all but one rest on the upper wall"),
    BothForms("less-chaotic", "4.4", "In general dissipation tends to discourage chaos",
        motions.count_chaotic, "chaotic at λ = 0.025, 0.05, 0.075, 0.15, 0.20, 0.25: {counts} of 3",
        lambda v: v.slow < v.fast, "as published only from about λ = 0.22 on"),
    BothForms("sliding-faster-with-gap", "4.4",
        "With sliding too an increase of the gap results in larger impact velocities",
        impacts.find_fastest, "largest velocity at ρ = 0.010, 0.015, 0.020: {each}", lambda v: v.rising,
        "by the largest velocities: the mean over bounces that end in rest has no limit"),
    BothForms("difference-of-walls", "4.4",
        "Increases of λ increase the difference between the impact velocities on the upper and the lower "
        "wall", partial(impacts.compare_walls, dampings=HIGH_DAMPINGS),
        "mean velocity on the upper and the lower wall, mean over ρ, at λ = 0.15, 0.20, 0.25: {pairs}",
        lambda v: is_rising(v.gaps), "at λ = 0.25 the lower wall is not hit at all"),
    of_kind("4.4, Fig. 4.33", "(0.20, 0.015) is chaotic",
        Case(0.20, 0.015), CHAOTIC),
    BothForms("slides-not-seldom", "4.4, Fig. 4.33",
        "(0.20, 0.015): during the chaotic motion sliding occurs not infrequently",
        motions.count_slides, "{words}", lambda v: min(v.exact, v.ruled) > 30,
        "F's routine may have taken slow impacts for sliding; a motion that slides is released from a "
        "fixed state, so recurrent sliding and chaos exclude each other"),
    of_kind("4.4", "(0.22, 0.015): approximately there only transient chaos is observed",
        Case(0.22, 0.015), TRANSIENT_CHAOS),
    BothForms("simple-periodic", "4.4", "At ρ = 0.015 simple periodic motion occurs for λ = 0.23 and above",
        motions.find_simple_periodic, "period 1 {exact_words}, with F's threshold {ruled_words}",
        lambda v: v.exact <= 0.23,
        "as published met with F's threshold only: the exact motion at 0.23 has a longer period"),
    of_kind("4.4, Fig. 4.35", "(0.25, 0.015) is periodic",
        Case(0.25, 0.015), PERIODIC),
    BothForms("low-velocity-cycles", "4.4, Figs. 4.34, 4.35",
        "(0.25, 0.015): cycles of low velocity impacts end in sliding, then release",
        motions.count_releases, "{onsets:g} beginnings of sliding and {lifts:g} releases per cycle",
        lambda v: v.onsets == v.lifts == 1.0, "corrected, the roller stays on the upper wall"),
    BothForms("insensitive", "4.4, Figs. 4.34, 4.36, 4.37",
        "At large λ small variations of the gap do not affect the periodicity",
        motions.find_periods, "λ = 0.25, 21 gaps from 0.010 to 0.020: periods {periods}",
        lambda v: min(v.periods) > 0),
    BothForms("no-lower-impacts", "4.4", "At λ = 0.25, and above, there are no impacts on the lower wall",
        impacts.count_lower,
        "{count} impacts on the lower wall in 300 cycles each at λ = 0.25, 0.26, 0.28, 0.35 and F's gaps",
        lambda v: v.count == 0, "although the force presses to the lower wall in a part of the cycle"),
    BothForms("lower-region", "4.4",
        "As λ increases, the region where the moment presses to the lower wall becomes smaller and moves "
        "towards θ = 0", force.follow_lower_region,
        "(ρ = 0.01) largest interval pressed to the lower wall: {each}; the middle is {from_zero[0]:.2f}, "
        "then {from_zero[2]:.2f} from θ = 0",
        lambda v: is_rising(v.sizes[::-1]) and is_rising(v.from_zero[::-1]),
        "barely: where it vanishes it is still more than 1 rad from θ = 0"),
    BothForms("lower-threshold", "4.4",
        "Beyond a critical λ, depending on ρ, no net moment pushes to the lower wall at any crank angle",
        force.find_thresholds, "λ = {lower:.4f} at ρ = 0.010, 0.015, 0.020",
        lambda v: v.lower[0] != v.lower[1] != v.lower[2]),
    BothForms("more-sliding", "4.4",
        "As e is reduced motions increase their sliding duration and become periodic, over all λ and ρ",
        motions.compare_restitutions,
        "e = 0.9, 0.7, 0.5, the 18 pairs (λ, ρ): slides {shares:.0f%} of the time; {irregular} irregular",
        lambda v: v.shares == sorted(v.shares) and v.irregular[-1] == 0),
    of_kind("4.4, Fig. 4.38", "(0.05, 0.02), e = 0.7: transient chaos",
        Case(0.05, 0.02, 0.7), TRANSIENT_CHAOS),
    of_kind("4.4, Fig. 4.39", "(0.05, 0.02), e = 0.5: periodic motion",
        Case(0.05, 0.02, 0.5), PERIODIC),
    BothForms("sliding-begins", "4.4, Figs. 4.42-4.44",
        "Near e = 1 no sliding occurs, and more often as e decreases; the motion develops substantial "
        "sliding",
        motions.compare_restitutions, "(0.05, 0.02), e = 0.9, 0.7, 0.5: slides {alone:.1f%} of the time",
        lambda v: v.alone[0] == 0.0 < v.alone[-1] and v.alone == sorted(v.alone)),
    BothForms("plastic-impacts", "4.4",
        "As e → 0 sliding nearly always occurs, as the rebound velocity is zero; periodic motions dominate",
        partial(motions.measure_sliding, restitution=0.0),
        "e = 0: {sliding} of {cases} pairs (λ, ρ) slide, {regular} are periodic in the end",
        lambda v: v.sliding == v.cases and v.regular > v.cases // 2,
        "with e = 0 an impact against the force touches the wall for an instant"),
    BothForms("dominated-by-sliding", "5",
        "With e ≈ 0.4, as in automotive applications, sliding motions will most likely dominate",
        partial(motions.measure_sliding, restitution=0.4),
        "e = 0.4: the 18 pairs (λ, ρ) slide {least_percent:.0f} to {most:.0f%} of the time, {mean:.0f%} on "
        "average; {sliding} of 18 slide", lambda v: v.mean > 0.5 and v.least > 0.0,
        "e = 0.4 is cited from Wilson and Fawcett (1974); dominate: more than half of the time"),
    BothForms("either-observed", "5",
        "Because of transient chaos either chaos or periodicity may be observed, by start and time scale",
        motions.count_starts,
        "(0.025, 0.01), {starts} starts: {short} would be periodic for most of 3000 cycles, {long} chaotic "
        "throughout", lambda v: v.short > 0 and v.long > 0),
)

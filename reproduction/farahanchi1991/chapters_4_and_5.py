"""F's statements: the motions of F's engine, and F's discussion."""

from functools import partial

from models.slider_crank.motions.classification import CHAOTIC, PERIODIC, TRANSIENT_CHAOS

from ..statement import Claim, Verdict, is_rising, state_verdict
from . import derivation, force, impacts, motions
from .both_forms import BothForms, of_kind
from .runs import HIGH_DAMPINGS, LOW_DAMPINGS, Case, Runs, list_cases

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
    BothForms("descending-series", "4.2",
        "Impacts move from lobe to lobe, from the upper left to the lower right: each slower than the one "
        "before", impacts.count_descending,
        "{slower:.1f%} of the {pairs} upper impacts that follow another in the same cycle are slower than it",
        lambda v: v.slower > 0.9, "as a rule: more than 90 %"),
    BothForms("several-lobes", "4.2, Fig. 4.3",
        "The attractor is composed of several lobes, some of them distinct",
        impacts.count_lobes, "{words}", lambda v: v.lobes > 1,
        "distinct in crank angle, to half a degree"),
    state_verdict("gap-misprint", "4.3", "The matrix has ρ = 0.01, 0.015, 0.2",
        "figures, captions and text that follow have ρ = 0.020", Verdict.CANNOT,
        "a misprint: with ρ = 0.2, |ψ| reaches 12°"),
    BothForms("matrix-kinds", "4.3", "All three types of response occur in the 3 × 3 matrix",
        motions.count_kinds, "{low}", lambda v: v.low_kinds == 3),
    state_verdict("listed-twice", "4.3",
        "Transient chaos at (0.025, 0.01), (0.025, 0.01), 0.015), and (0.075, 0.01) (Figs. 4.6, 4.7, 4.12)",
        "Fig. 4.7 is (0.025, 0.015)", Verdict.CANNOT,
        "a pair stands twice; the second is (0.025, 0.015)"),
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
    BothForms("background", "4.3",
        "In transient chaos the uniform background of the distribution decreases with the length of the "
        "sample", impacts.measure_background,
        "(0.075, 0.01): {shares[0]:.1f%} of the impacts of 1500 cycles and {shares[1]:.1f%} of 3000 are of "
        "the transient ({length} cycles)", lambda v: v.shares[1] < v.shares[0]),
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
    BothForms("upper-worn", "4.3, Figs. 4.6-4.14", "The same, of the profiles' areas",
        partial(impacts.compare_walls, dampings=LOW_DAMPINGS),
        "velocities per cycle, upper wall over lower, at λ = 0.025, 0.05, 0.075: {ratios:.2f}",
        lambda v: min(v.ratios) > 1.0 and is_rising(v.ratios),
        "the bars of (3.6) weigh the velocities by the number of impacts"),
    BothForms("slow-impacts", "4.3", "In all cases there are regions of very small impact velocities",
        impacts.find_slowest,
        "{slow} of {cases} cases have impacts slower than {limit}; the slowest are {low:.0e} to "
        "{high:.0e}{others}", lambda v: v.slow == v.cases,
        "very small: below a tenth of the mean"),
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
    BothForms("lower-wall-trend", "4.4",
        "As λ increases the impacts on the lower wall become more limited in place, more severe, and shift "
        "to the head end",
        impacts.follow_lower, "5 to 95 % of the lower impacts, mean velocity: {each}",
        lambda v: v.narrower and v.harder and v.higher,
        "all gaps together; first against last λ with such impacts"),
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
    state_verdict("wrong-figures", "4.4",
        "For (0.05, 0.02): Poincaré maps Figs. 4.21, 4.38, 4.39, distributions Figs. 4.8, 4.40, 4.41",
        "Fig. 4.21 is (0.075, 0.02), Fig. 4.8 is (0.025, 0.02); the captions of 4.40 and 4.41 say λ = 0.025",
        Verdict.CANNOT,
        "text and captions contradict each other; the distribution of (0.05, 0.02), e = 0.9, is Fig. 4.11. "
        "Figs. 4.40 and 4.41 are drawn for the caption's λ and for the text's"),
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
    BothForms("fewer-impacts", "5",
        "Increases in sliding duration are typically correlated with fewer impacts per cycle",
        motions.correlate_sliding,
        "correlation of sliding share and impacts per cycle {value:+.2f} (54 cases, F's threshold)",
        lambda v: v.value < 0.0,
        "with F's threshold, as every slide begins with infinitely many impacts"),
    state_verdict("averages-lost", "5",
        "An integral average measure cannot be obtained from the pattern of the Poincaré map",
        "(3.6) of the upper wall is the sum of x₂ over the points of Σ by θ", Verdict.NOT_MET,
        "the map's points hold angle and velocity of every upper impact"),
    state_verdict("four-dimensions", "5",
        "The Poincaré map of a model with two degrees of freedom is four-dimensional",
        "two angles, two rates and the crank angle, less one by the impact's condition: 4",
        Verdict.MET),
)

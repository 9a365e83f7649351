"""F's statements: abstract, derivation, walls and their forces, Poincaré section."""

from models.slider_crank.motions.regions import TURN

from ..statement import Claim, Verdict, is_near, state_verdict
from . import derivation, force, impacts, motions
from .both_forms import BothForms, of_symmetry
from .runs import Runs

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
    state_verdict("permuted-list", "List of figures",
        "Figs. 4.15-4.17 are (0.05, 0.015), Figs. 4.18-4.20 (0.025, 0.01)",
        "captions and text: Figs. 4.15-4.17 are (0.025, 0.01), Figs. 4.18-4.20 (0.05, 0.015)",
        Verdict.CANNOT, "the list contradicts the captions and the text; drawn as captioned"),
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
    Claim("equation-2-8", "(2.8)",
        "½m{{−Ω²rl[sin Ωt cos(φ−ψ) − cos Ωt sin(φ−ψ)] …}} − M{{Ω²rl[… + l²(φ̈−ψ̈)]}} + …",
        derivation.compare_equations,
        "differs by up to {of_2_8:.3f} M l²Ω² from Lagrange's equation of F's own energy (2.5)",
        Verdict.CANNOT,
        "the first minus must be a plus, and l²(φ̈−ψ̈) does not belong into a bracket with the factor "
        "Ω²rl; (2.10) is right in both"),
    state_verdict("scaling", "2.3", "τ = Ωt and ()' = Ω(˙)",
        "d/dt = Ω d/dτ: (˙) = Ω()'", Verdict.CANNOT,
        "the equations use (˙) = Ω()'"),
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
    Claim("symmetric-walls", "2.5", "ψ_max = −ψ_min is valid only in the linearized case",
        derivation.check_walls, "exact walls at ρ = 0.02: |ψ_max + ψ_min| up to {sum:.1e} rad",
        lambda v: v.sum > 1e-6),
    Claim("impact-rule", "(2.16), (2.17)",
        "ẏ_s after = −e ẏ_s before gives ψ̇ after = (1+e) ξ² sin τ cos τ/Λ² ψ − e ψ̇ before",
        derivation.check_walls,
        "velocities relative to the wall after and before are in the ratio −e to {fault:.0e}",
        lambda v: v.fault < 1e-15),
    Claim("coming-to-rest", "2.6",
        "The ball comes to rest in finite time after infinitely many bounces; so does the roller",
        derivation.sum_bounces,
        "400 bounces at e = 0.9 take {share:.12f} of 2v/(g(1 − e)); at (0.25, 0.015) the roller is still "
        "after {impacts} impacts, when less than rounding is left of the sum",
        lambda v: is_near(v.share, 1.0, 1e-12),
        "cited from Greenwood, pp. 160-161, which was not at hand"),
    Claim("when-it-slides", "2.6",
        "Sliding occurs when the friction is large or the coefficient of restitution small",
        derivation.measure_sliding,
        "share of the time in which it slides: (0.05, 0.01): {plain:.0f%}, λ = 0.25: {damped:.0f%}, e = "
        "0.5: {soft:.0f%}", lambda v: v.plain == 0.0 < min(v.damped, v.soft)),
    BothForms("four-regions", "2.6",
        "There are four kinds of crank angles: sliding on the upper wall only, lower only, either, neither",
        force.divide_turn, "rad of a turn at (0.1, 0.01): {each}", lambda v: v.least > 0.0),
    Claim("virtual-work", "(2.22)-(2.26)", "δW = −F_u l cos(φ − ψ) δψ", derivation.check_walls,
        "∂y/∂ψ of y = l sin φ − l sin(φ − ψ): {lever:.8f} l, cos(φ − ψ) = {cosine:.8f}",
        lambda v: abs(v.lever - v.cosine) < 1e-9),
    state_verdict("repeated-energy", "2.6 after (2.26)",
        "T_total (from 2.5) = ½M{{… + [rΩ cos Ωt − ½l(φ̇−ψ̇) cos(φ−ψ)]²}} + …",
        "(2.4), (2.5): the slider's vertical velocity is r Ω cos Ωt − l(φ̇−ψ̇) cos(φ−ψ)",
        Verdict.CANNOT, "a misprint: the ½ belongs to the rod alone"),
    Claim("equation-2-27", "(2.27), (2.29)",
        "… − β(φ'' − ψ'') = −f_u cos(φ−ψ) + … in (2.27), … + β(φ'' + ψ'') … in (2.29)",
        derivation.compare_equations,
        "(2.27) differs by up to {own_2_27:.3f} from Lagrange's equation of F's energy (2.5) and by "
        "{rod_2_27:.0e} from that with the rod's right rate φ' − ψ'", Verdict.CANNOT,
        "(2.27) is right, printed once and not used: all figures follow from (2.10) and (2.29)"),
    state_verdict("force-scale", "2.6 after (2.26)", "Dividing by M l Ω² gives (2.27)",
        "the terms are moments, M l² Ω²; F_u l over that is f_u = F_u/(M l Ω²), (2.28)",
        Verdict.CANNOT, "must be M l² Ω², as in 2.3"),
    Claim("restitution-no-part", "2.6", "The coefficient of restitution cannot affect the constraint force",
        force.compare_restitutions, "forces with e = 0, 0.5 and 1 differ by {spread:.0e}",
        lambda v: v.spread == 0.0),
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
    BothForms("section", "(3.4)", "Σ = {{x₁ = ψ_max, x₂ > 0}} holds the impacts on the upper wall",
        impacts.count_backward, "{backward} of {total} upper impacts have ψ' ≤ 0, down to {least:.4f}",
        lambda v: v.backward == 0,
        "the wall itself moves: x₂ > ψ'_max it must be, with ψ'_max = ½ξ² sin 2τ ψ_max/Λ²"),
    Claim("ends-of-stroke", "3.2", "x ∈ [1 − ξ, 1 + ξ]; x = 1 − ξ at θ = (2n+1)π, x = 1 + ξ at θ = 2nπ",
        impacts.locate_stroke, "x = {head:.4f} at 0, {crank_end:.4f} at π; at π/2 {middle:.4f}",
        lambda v: v.off < 1e-12, "the middle of the stroke is passed after half of the time"),
    BothForms("profile-average", "(3.6), (3.7)",
        "⟨ψ̇(Δx_i)⟩ = Σ ψ̇_k/N is the average impact velocity of the interval Δx_i", impacts.average_profile,
        "the bars of (3.6) add up to {sum:.5f}, the mean impact velocity is {mean:.5f}", Verdict.NOT_MET,
        "an average would divide by N_i; with N it is the average times the share N_i/N of the impacts"),
    Claim("profile-without-limit", "(3.6), 4.4",
        "Profiles of motions that slide show the impacts and their severity", impacts.sum_velocities,
        "(0.25, 0.015): {counts[1]:.0f} impacts a cycle by F's threshold of sliding, {counts[0]:.0f} until "
        "rounding, infinitely many in the limit; velocities per cycle {sums[1]:.4f} and {sums[0]:.4f}",
        Verdict.CANNOT,
        "divided by N, a profile with chatter falls without limit as the threshold is made smaller; "
        "divided by the cycles, as here, it converges"),
    BothForms("limiting-distribution", "3.2", "As N → ∞ the profiles converge to a limiting distribution",
        impacts.compare_records,
        "(0.025, 0.02): {errors[0]:.1f%} and {errors[1]:.1f%} away after 3000 and 12000 cycles from the "
        "profile after 192000", lambda v: v.errors[1] < v.errors[0]),
    BothForms("polar-representation", "3.3",
        "Impact spectra are a polar representation of the data of the profiles", impacts.split_directions,
        "{out:.0f%} of the upper impacts on the way from the head, {back:.0f%} on the way back",
        lambda v: min(v.out, v.back) == 0.0,
        "they hold more: θ and 2π − θ are the same place x"),
    state_verdict("transient-length", "4.2, appendix B",
        "Transients have decayed after 25 cycles (4.2); 30 are allowed to achieve steady state (appendix B)",
        "25 and 30", Verdict.CANNOT,
        "30 taken. For transient chaos neither is enough"),
)

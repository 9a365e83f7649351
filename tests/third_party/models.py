"""Models of the FMUs in C (`c_fmus`), as of the Modelica Reference-FMUs, and their vices."""

from dataclasses import dataclass, field, replace

from .vices import VICES


@dataclass(frozen=True)
class V:
    """A variable; `size` > 1 makes it an array, of FMI 3.0 only, whose elements the structural parameter
    `counted` counts, if there is one."""

    name: str
    causality: str = "local"
    start: object = 0.0
    type: str = "Float64"
    unit: str = ""
    initial: str = ""
    size: int = 1
    derivative: str = ""
    more: str = ""
    items: tuple[tuple[str, int], ...] = ()
    counted: str = ""
    varying: str = ""  # its variability, if that is not what its type suggests
    inside: str = ""  # elements of FMI 3.0

    @property
    def starts(self) -> list[float]:
        values = self.start if isinstance(self.start, list) else [self.start] * self.size
        return [float(value) for value in values] + [0.0] * (self.size - len(values))


@dataclass(frozen=True)
class Model:
    """`step` is C that moves v from t to t + h (`h`), `output` C that computes outputs of v and inputs.

    Variables are named in C by macros: `$name`. `depends`: the inputs of every output; `rates`: the variables
    that are derivatives of outputs, for the standard's call. Derivatives of inputs are taken up to the order
    `highest`.
    """

    variables: tuple[V, ...]
    step: str = ""
    output: str = ""
    depends: dict[str, tuple[str, ...]] = field(default_factory=dict)
    abilities: str = 'canGetAndSetFMUstate="true" canSerializeFMUstate="true" '
    variable_step: bool = True
    rates: dict[str, str] = field(default_factory=dict)
    reading: str = "OK"  # the status of getters
    leaving: str = "OK"  # that of the end of initialisation
    highest: int = 3  # less than 0: their call is an error


EXPONENTIAL = "$x = $x * exp(-$k * h);"
MODELS = {
    # dx/dt = -k x, exactly.
    "dahlquist": Model((V("x", "output", 1.0, initial="exact"), V("k", "parameter", 1.0)), EXPONENTIAL),
    # dx/dt = v, dv/dt = -g, v <- -e v where x falls through 0; by Euler's steps of 1 ms.
    "ball": Model(
        (
            V("body.h", "output", 1.0, unit="m", initial="exact"),
            V("body.v", "output", 0.0, unit="m/s", initial="exact"),
            V("g", "parameter", 9.81),
            V("e", "parameter", 0.7),
            V("der(body.h)", "local", unit="m/s", derivative="body.h"),
        ),
        """
        int n = (int)round(h / 1e-3);
        for (int i = 0; i < n; i++) {
            ${body.h} += 1e-3 * ${body.v};
            ${body.v} -= 1e-3 * $g;
            if (${body.h} < 0.0 && ${body.v} < 0.0) { ${body.h} = 0.0; ${body.v} = -$e * ${body.v}; }
        }""",
        "${der(body.h)} = ${body.v};",
    ),
    # Van der Pol's oscillator, driven; by Heun's steps of 1 ms at most.
    "vanderpol": Model(
        (
            V("x", "output", 2.0, initial="exact"),
            V("v", "output", 0.0, initial="exact"),
            V("mu", "parameter", 1.0),
            V("force", "input"),
        ),
        """
        int n = (int)ceil(h / 1e-3 - 1e-9);
        for (int i = 0; i < n; i++) {
            double d = h / n, a = $mu * (1 - $x * $x) * $v - $x + $force;
            double p = $x + d * $v, q = $v + d * a;
            double b = $mu * (1 - p * p) * q - p + $force;
            $x += 0.5 * d * ($v + q); $v += 0.5 * d * (a + b);
        }""",
        depends={"x": (), "v": ()},
    ),
    "feedthrough": Model(
        (
            V("real in", "input", unit="m"),
            V("real out", "output", unit="m"),
            V("whole_in", "input", 0, "Int32"),
            V("whole_out", "output", 0, "Int32"),
            V("truth_in", "input", False, "Boolean"),
            V("truth_out", "output", False, "Boolean"),
            V("offset", "parameter", 0.0),
            V("count", "parameter", 0, "Int32"),
            V("negate", "parameter", False, "Boolean"),
        ),
        output="${real out} = ${real in} + $offset; $whole_out = $whole_in + $count; "
        "$truth_out = ($truth_in != 0) != ($negate != 0);",
        depends={"real out": ("real in",), "whole_out": ("whole_in",), "truth_out": ("truth_in",)},
    ),
    # Counts the seconds.
    "stair": Model((V("counter", "output", 0, "Int32"),), "$counter = floor(t + h + 1e-9);"),
    # y = A x, dx/dt = u, exactly for held inputs; arrays.
    "vector": Model(
        (
            V("x0", "parameter", [1.0, 2.0], size=2),
            V("A", "parameter", [1.0, 0.0, 0.0, 1.0], size=4),
            V("u", "input", [0.0, 0.0], size=2),
            V("y", "output", [0.0, 0.0], size=2),
            V("slope", "output", [0.0, 0.0], size=2, derivative="y"),
            V("started", "local"),
        ),
        "for (int i = 0; i < 2; i++) (&$x0)[i] += h * (&$u)[i];",
        """for (int i = 0; i < 2; i++) {
            (&$y)[i] = (&$A)[2 * i] * (&$x0)[0] + (&$A)[2 * i + 1] * (&$x0)[1];
            (&$slope)[i] = (&$A)[2 * i] * (&$u)[0] + (&$A)[2 * i + 1] * (&$u)[1];
        }""",
        depends={"y": (), "slope": ("u",)},
    ),
    # dx/dt = u, exactly for held inputs; `n` of each.
    "sized": Model(
        (
            V("n", "structuralParameter", 2, "UInt64", more='min="1" max="4" '),
            V("x0", "parameter", [1.0, 2.0], size=4, counted="n"),
            V("u", "input", [0.0, 0.0], size=4, counted="n"),
            V("y", "output", [0.0, 0.0], size=4, counted="n"),
        ),
        "for (int i = 0; i < $n; i++) (&$x0)[i] += h * (&$u)[i];",
        "for (int i = 0; i < $n; i++) (&$y)[i] = (&$x0)[i];",
        depends={"y": ()},
    ),
    # dy/dt = u, exactly for inputs that are cubics.
    "integral": Model(
        (V("y", "output"), V("u", "input"), V("u1"), V("u2"), V("u3")),
        "$y += h * ($u + h / 2 * ($u1 + h / 3 * ($u2 + h / 4 * $u3)));",
        abilities='canGetAndSetFMUstate="true" canInterpolateInputs="true" ',
    ),
    # y = gain u + x, dx/dt = push - decay u, exactly for inputs that are cubics.
    "feedback": Model(
        (
            V("y", "output"), V("u", "input"), V("u_der1", "input"), V("u_der2", "input"),
            V("u_der3", "input"), V("gain", "parameter", 1.0), V("decay", "parameter", 1.0),
            V("push", "parameter"), V("x", "local", 1.0, initial="exact"), V("der(y)", derivative="y"),
        ),
        """
        $x += h * ($push - $decay * ($u + h / 2 * ($u_der1 + h / 3 * ($u_der2 + h / 4 * $u_der3))));
        $u += h * ($u_der1 + h / 2 * ($u_der2 + h / 3 * $u_der3));
        $u_der1 += h * ($u_der2 + h / 2 * $u_der3);
        """,
        "$y = $gain * $u + $x; ${der(y)} = $gain * $u_der1 + $push - $decay * $u;",
        depends={"y": ("u",)},
    ),
    # A mass on a spring and a damper: m a = f - k x - d v, by Heun's steps of 0.1 ms at most.
    "sprung": Model(
        (
            V("position", "output", unit="m", initial="exact"),
            V("velocity", "output", unit="m/s", initial="exact"),
            V("force", "input"),
            V("mass", "parameter", 1.0),
            V("stiffness", "parameter", 10.0),
            V("damping", "parameter", 0.5),
            V("der(position)", unit="m/s", derivative="position"),
            V("der(velocity)", derivative="velocity"),
        ),
        """
        int n = (int)ceil(h / 1e-4 - 1e-9);
        for (int i = 0; i < n; i++) {
            double d = h / n, a = ($force - $stiffness * $position - $damping * $velocity) / $mass;
            double p = $position + d * $velocity, q = $velocity + d * a;
            double b = ($force - $stiffness * p - $damping * q) / $mass;
            $position += 0.5 * d * ($velocity + q); $velocity += 0.5 * d * (a + b);
        }""",
        "${der(position)} = $velocity; "
        "${der(velocity)} = ($force - $stiffness * $position - $damping * $velocity) / $mass;",
        depends={"position": (), "velocity": ()},
        abilities='providesDirectionalDerivative="true" ',
    ),
    # Tells how long the text that it is given before its initialisation is, and its first two bytes.
    "reading": Model(
        (V("table file", "parameter", type="String"), V("raw", "parameter", type="Binary"),
         V("scale", "parameter", 1.0), V("length", "output"), V("first", "output"), V("second", "output")),
        output="$length = $scale * strlen(m->text); $first = m->text[0] & 255; $second = m->text[1] & 255;",
        depends={"length": (), "first": (), "second": ()},
    ),
    # Of a material, whose numbers have a gap; its length in mm.
    "stretched": Model(
        (V("material", "parameter", 1, "Enumeration", items=(("steel", 1), ("brass", 2), ("other", 9))),
         V("length", "output", 1.0, unit="mm", initial="exact"), V("number", "output")),
        output="$number = $material;",
        depends={"length": (), "number": ()},
    ),
    # What names may be.
    "named": Model((V('a/b "c", [µ] <->', "output", 1.0, initial="exact"), V("der(x)", "output", 2.0)), ""),
    "shaft": Model(
        (V("speed", "output", 0.0, unit="r/min"), V("height", "input", unit="mm"),
         V("reached", "output", unit="mm"),
         V("air", "output", 20.0, unit="degC"), V("wall", "input", unit="K"), V("bare", "input"),
         V("felt", "output", unit="K"), V("given", "output")),
        "$speed = 60.0 * (t + h);",
        "$reached = $height; $felt = $wall; $given = $bare;",
        depends={"speed": (), "air": (), "reached": ("height",), "felt": ("wall",), "given": ("bare",)},
    ),
}  # fmt: skip

DECAY = MODELS["dahlquist"]
# Two truths, as a number and as what it is, and the time.
MODELS["switch"] = Model(
    (V("gear", "output", varying="discrete"), V("on", "output", False, "Boolean"), V("ramp", "output")),
    "$gear = (int)floor((t + h) / 0.03 + 1e-9) % 2; $ramp = t + h;",
    "$on = $gear;",
)
# Counts the steps in which one of its inputs is neither 0 nor 1.
MODELS["lookup"] = Model(
    (V("gear", "input", varying="discrete"), V("level", "input"), V("flag", "input"),
     V("sampled", "input", varying="discrete"), V("strange", "output"), V("seen", "output")),
    """if ($gear != 0 && $gear != 1) $strange += 1;
    if ($level != 0 && $level != 1) $strange += 1;
    if ($flag != 0 && $flag != 1) $strange += 1;
    $seen = $sampled;""",
)  # fmt: skip

# What they count is no part of the state that they save.
for name, counted in {"forgetful": "h", "collecting": "$u * h"}.items():
    MODELS[name] = Model(
        (V("passed", "output"), V("u", "input")),
        f"*(double *)m->text += {counted}; $passed = *(double *)m->text;",
        depends={"passed": ()},
    )
# From half of the run on it discards steps of more than 3 ms after 2 ms.
MODELS["forgetful hasty"] = replace(
    MODELS["forgetful"],
    step="const double part = t > 0.495 && h > 3e-3 ? 2e-3 : h; *(double *)m->text += part; "
    "$passed = *(double *)m->text; if (part < h) { m->reached = t + part; return DISCARD; }",
)
LIMITED = "if (t > 0.495) "
for _name, _code in VICES.items():
    MODELS[_name] = Model(DECAY.variables, f"{LIMITED}{_code} {EXPONENTIAL}")
# Comes back halfway through every step that is longer than 6 ms.
MODELS["early"] = Model(
    DECAY.variables,
    "if (h > 6e-3) { $x *= exp(-$k * h / 2); m->reached = t + h / 2; return EARLY; } " + EXPONENTIAL,
    abilities='mightReturnEarlyFromDoStep="true" ',
)
# From half of the run on discard steps of more than 3 ms: after 2 ms, and with a state that is wrong.
for _name, _way in {
    "hasty": "$x *= exp(-$k * 2e-3); m->reached = t + 2e-3;",
    "spoiling": "$x += 1.0;",
}.items():
    MODELS[_name] = replace(
        DECAY, step=f"if (t > 0.495 && h > 3e-3) {{ {_way} return DISCARD; }} {EXPONENTIAL}"
    )
# Come back early without having got anywhere, from before the step, and from no time at all.
for _name, _reached in {"stuck": "t", "backwards": "t - 1", "timeless": "0.0 / 0.0"}.items():
    MODELS[_name] = replace(
        MODELS["early"], step=f"if (t > 0.495) {{ m->reached = {_reached}; return EARLY; }} " + EXPONENTIAL
    )
# The decay with other steps.
_STEPS = {
    # Print in every step, to both streams; one crashes.
    "printing": f'printf("at %g\\n", t); fprintf(stderr, "of %g\\n", h); {EXPONENTIAL}',
    "printing_crash": 'printf("at %g\\n", t); ' + MODELS["crashing"].step,
    # Is a number, and finite, until half of the run.
    "vanishing": f"{EXPONENTIAL} {LIMITED}$x = 0.0 / 0.0;",
    "growing": f"{EXPONENTIAL} {LIMITED}$x = 1.0 / 0.0;",
    # Takes 600 MB in its first step after half a second.
    "greedy": f"{LIMITED}{{ char *all = malloc(600000000); "
    'if (!all) { say(m, ERROR, "no memory left"); return ERROR; } '
    f"memset(all, 1, 600000000); free(all); }} {EXPONENTIAL}",
    # Euler's steps of a tenth of a macro step, of what is 25 times too fast for them.
    "diverging": "for (int i = 0; i < 10; i++) $x -= h / 10 * 5e4 * $k * $x;",
    # Takes 2 ms for a step.
    "slow": f"usleep(2000); {EXPONENTIAL}",
    # Reads standard input in every step, and expects its end.
    "listening": f"char byte; if (read(0, &byte, 1) != 0) return ERROR; {EXPONENTIAL}",
    # Says why in a message with arguments, as FMI 2.0 has them.
    "formatting": f'{LIMITED}{{ m->log->logger(m->environment, m->name, ERROR, "logStatus", '
    '"the %s of %s burst at %g s, 100 %%", "boiler", m->name, t); return ERROR; } ' + EXPONENTIAL,
    # Warn of every step after half a second, with a message and without.
    "warning": f'{EXPONENTIAL} {LIMITED}{{ say(m, WARNING, "getting hot"); '
    "m->reached = t + h; return WARNING; }",
    "muttering": f"{EXPONENTIAL} {LIMITED}{{ m->reached = t + h; return WARNING; }}",
    # Returns what is no status; goes on when its step has returned.
    "unstepped": f"{EXPONENTIAL} return 7;",
    "pending": f"{LIMITED}return 5; {EXPONENTIAL}",
}
MODELS |= {name: replace(DECAY, step=step) for name, step in _STEPS.items()}
# Its output follows its input for the first 0.3 s only.
MODELS["freezing"] = Model(
    (V("y", "output"), V("u", "input"), V("frozen")),
    "$frozen = t > 0.295;",
    "if (!$frozen) $y = 2 * $u;",
    depends={"y": ("u",)},
)
# The mass, shaken by a force of its own: $force cos($frequency t).
SHAKEN = MODELS["sprung"].step.replace("$force", "$force * cos($frequency * (t + i * d))", 1)
SHAKEN = SHAKEN.replace("($force -", "($force * cos($frequency * (t + i * d + d)) -", 1)
MODELS["shaken"] = replace(
    MODELS["sprung"],
    variables=(
        *(v for v in MODELS["sprung"].variables if v.name != "force"),
        V("force", "parameter", 1.0),
        V("frequency", "parameter", 4.0, unit="rad/s"),
    ),
    step=SHAKEN,
    output="",
    abilities="",
)
# These give their rates by the standard's call only.
MODELS["called"] = replace(
    MODELS["sprung"],
    variables=tuple(replace(v, derivative="") for v in MODELS["sprung"].variables),
    abilities='maxOutputDerivativeOrder="1" ',
    rates={"position": "der(position)", "velocity": "der(velocity)"},
)
# The same with a rate that is no number before the first step.
MODELS["called_late"] = replace(
    MODELS["called"],
    variables=(*MODELS["called"].variables, V("moved")),
    step=MODELS["called"].step + " $moved = 1;",
    output=MODELS["called"].output + " if (!$moved) ${der(position)} = NAN;",
)
# The same that gives no rates.
MODELS["unrated"] = replace(MODELS["called"], abilities="", rates={})
# Takes the first derivative of its input only: a call with others is ignored, as the standard allows.
MODELS["first_slope"] = replace(MODELS["integral"], highest=1)
# Takes none, though it says so.
MODELS["claiming"] = replace(MODELS["integral"], highest=-1)
# The mass that takes no slope of its force, and can be taken back.
MODELS["held_mass"] = replace(MODELS["sprung"], abilities=DECAY.abilities)
MODELS["printing_mass"] = replace(
    MODELS["held_mass"], step='printf("moving\\n"); ' + MODELS["held_mass"].step
)
MODELS["printing_mass_first"] = replace(
    MODELS["held_mass"], output='printf("no licence\\n"); raise(SIGSEGV);'
)
# It ends the simulation at 0.8 s.
MODELS["ending_mass"] = replace(
    MODELS["held_mass"],
    step='if (t + h > 0.8) { say(m, OK, "worn out"); return ENDED; } ' + MODELS["held_mass"].step,
)
# The same without the way back.
MODELS["stateless_mass"] = replace(MODELS["sprung"], abilities="")
# A mass of 1 kg that falls, exactly for held forces, and a spring without mass that it may touch at 0.
MODELS["falling"] = Model(
    (
        V("position", "output", 0.1, initial="exact"),
        V("velocity", "output", initial="exact"),
        V("force", "input"),
    ),
    "double a = $force - 9.81; $position += h * ($velocity + h / 2 * a); $velocity += h * a;",
    depends={"position": (), "velocity": ()},
)
MODELS["stop"] = Model(
    (V("force", "output"), V("position", "input"), V("stiffness", "parameter", 1e6)),
    output="$force = $position < 0 ? -$stiffness * $position : 0;",
    depends={"force": ("position",)},
)
# Its output is the time derivative of its input.
MODELS["inertia"] = Model(
    (V("reaction", "output"), V("speed", "input"), V("speed_der1", "input"), V("inertia", "parameter", 0.5)),
    output="$reaction = -$inertia * $speed_der1;",
    depends={"reaction": ("speed", "speed_der1")},
)
MODELS["called_vector"] = replace(
    MODELS["vector"],
    variables=tuple(replace(v, derivative="") for v in MODELS["vector"].variables),
    abilities=MODELS["vector"].abilities + 'maxOutputDerivativeOrder="1" ',
    rates={"y": "slope"},
)
# Its output is right only when initialisation is over.
MODELS["late"] = Model(
    (V("x", "output"), V("x0", "parameter", 0.5)), output="if (m->initialised) $x = $x0;", depends={"x": ()}
)
# Warns whenever it is read.
MODELS["uneasy"] = replace(DECAY, reading="m->initialised ? WARNING : OK")
# Warns at the end of its initialisation.
MODELS["starting"] = replace(DECAY, leaving="WARNING")
# Return what is no status.
MODELS["unreadable"] = replace(DECAY, reading="m->initialised ? -1 : OK")
MODELS["unready"] = replace(DECAY, leaving='(say(m, ERROR, "not ready"), -1)')
# Asks for the end of the simulation when it has come to a time.
MODELS["landing"] = Model(
    (*DECAY.variables, V("until", "parameter", 0.51)),
    "double d = fmin(h, $until - t); $x *= exp(-$k * d); m->reached = t + d; "
    'if (t + h > $until - 1e-9) { say(m, OK, "has landed"); return ENDED; }',
)
# Cannot be looked at.
MODELS["blind"] = replace(DECAY, output="raise(SIGSEGV);")
MODELS["printing_first"] = replace(MODELS["blind"], output='printf("no licence\\n"); raise(SIGSEGV);')
# Makes steps as long as its first one.
ALIKE = "static double one; if (!one) one = h; if (fabs(h / one - 1) > 1e-6) return ERROR;"
MODELS["rigid"] = Model(DECAY.variables, f"{ALIKE} {EXPONENTIAL}", abilities="", variable_step=False)
MODELS["single"] = Model(
    DECAY.variables, EXPONENTIAL, abilities='canBeInstantiatedOnlyOncePerProcess="true" '
)

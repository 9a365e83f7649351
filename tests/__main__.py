"""Every check in order: lint, format, types, import rules, C, JavaScript (where `tsc` is installed), tests.

`python -m tests` runs the default part, `python -m tests --all` also the long physics checks.
`python -m tests --validation [WORD ...]` runs the tests that record numbers and writes docs/validation.md
and docs/measurements.md.
`python -m tests --mutants [WORD ...]` makes deliberate errors of physics and lists the tests that catch them.
`python -m tests --machines [--all] [WORD ...]` compares these numbers between machines, see `machines`.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from . import mutants
from .machines import compare_machines
from .validation import recording_tests

ROOT = Path(__file__).parent.parent
SCRIPTS = Path(sys.executable).parent

# A process for each processor, at most four for their memory (2 GB each). Each begins with a stretch of
# neighbouring tests, which share compiled kernels, and takes from another's end when it has none left.
PARALLEL = ["-n", "logical", "--maxprocesses", "4", "--dist", "worksteal"]


PYTEST = [sys.executable, "-m", "pytest", "-q", "--durations=10", *PARALLEL]


# The token is a macro that each FMU defines; conditions may be constant for some sizes of a component.
CPPCHECK = ["cppcheck", "--quiet", "--error-exitcode=1", "--std=c11", "--inline-suppr", '-DTOKEN="token"']
CPPCHECK += ["--enable=warning,style,performance,portability", "--suppress=knownConditionTrueFalse"]


def checks(everything: bool) -> dict[str, list[str]]:
    """The command of each check."""
    python, compiler = [sys.executable, "-m"], shutil.which("tsc")
    return {
        "lint": [*python, "ruff", "check", "."],
        "format": [*python, "ruff", "format", "--check", "."],
        "types": [*python, "mypy"],
        "imports": [str(SCRIPTS / "lint-imports"), "--no-cache"],
        "C": [*python, *CPPCHECK, "fmus", "interop"],
        **({"JavaScript": [compiler, "-p", "jsconfig.json"]} if compiler else {}),
        "tests": [*PYTEST, *(["-m", ""] if everything else [])],
    }


def recording(words: list[str]) -> list[str]:
    """The command that runs the recording tests whose file or name contains a word, or all."""
    tests = [
        f"tests/{test}"
        for test in sorted(recording_tests() | recording_tests("published"))
        if not words or any(w in test for w in words)
    ]
    if not tests:
        raise SystemExit(f"no test that records numbers has {' or '.join(words)} in its file or name")
    return [*PYTEST, *tests]


def refuse_unknown(arguments: list[str]) -> None:
    """End with the usage where it is asked for, or an option is none of ours."""
    if "-h" in arguments or "--help" in arguments:
        print(__doc__)
        raise SystemExit(0)
    modes = "--mutants", "--machines", "--validation"
    worded = arguments[:1] and arguments[0] in modes
    for argument in arguments[1:] if worded else arguments:
        if argument != "--all" and (argument.startswith("-") or not worded):
            print(f"{argument}: is no option of python -m tests\n\n{__doc__}", file=sys.stderr)
            raise SystemExit(2)


def main() -> int:
    """Run all checks, also after one failed; 0 only if all passed."""
    refuse_unknown(sys.argv[1:])
    # Tests start hundreds of processes: each would compile all modules anew where bytecode is not kept.
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    failed, arguments = [], sys.argv[1:]
    if arguments[:1] == ["--mutants"]:
        return mutants.main(arguments[1:])
    if arguments[:1] == ["--machines"]:
        command = recording([word for word in arguments[1:] if word != "--all"])
        return 0 if compare_machines([*command, *(["-m", ""] if "--all" in arguments else [])], ROOT) else 1
    if arguments[:1] == ["--validation"]:
        commands = {"validation": [*recording(arguments[1:]), "-p", "tests.manuals", "-m", ""]}
    else:
        commands = checks("--all" in arguments)
    for name, command in commands.items():
        print(f"== {name}", flush=True)
        if subprocess.run(command, cwd=ROOT, env=environment, check=False).returncode != 0:
            failed.append(name)
    print(f"failed: {', '.join(failed)}" if failed else "all checks passed", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

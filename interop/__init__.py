"""Other tools run our FMUs: `python -m interop` writes docs/reference/tools.md.

A tool is a file in `tools/`. It runs with the interpreter of the tool's own environment, which can import
only the tool's packages and this folder. It has

- TITLE; REQUIREMENTS, the packages that pip installs; USE, what else its user needs, or "nothing";
- version(): the tool's version, or an exception that says what is missing;
- values(case): all outputs after every step. Each step holds its row of the case's input table;
- optionally steps(count, step): time and size of each step, if the steps do not begin at i * step;
- optionally FMI: the versions that the tool takes, if not both;
- optionally PLATFORM: the platform of native FMUs, if it is not this one;
- optionally FINDINGS: lines for the page.

A tool calls `case.report_loaded()` when it has an instance of the FMU.
"""

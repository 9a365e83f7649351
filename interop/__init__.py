"""Other tools run our FMUs: the matrix of docs/tools.md, and what its tests share.

A tool is a file in `hosts/`. It is run with the interpreter of the tool's environment, where nothing but the
tool's packages and this folder can be imported, and has

- TITLE; REQUIREMENTS, the packages that pip installs; USE, what its user needs besides, in a few words;
- version(): the tool's version, or an exception that says what is missing;
- values(case): all outputs after every step, with the inputs of the case's table held in each step;
- timing(case): a context that gives a function: how long the tool's own loop takes for so many steps, with
  the inputs of the first row held, and as little recorded as the tool lets. Its first call is not counted;
- steps(count, step), only where the tool's steps are not at i * step: the time and size of each;
- NEXT_INPUTS, only where outputs are those with the inputs of the next step set: true;
- FMI, only where the tool does not take both versions: those that it takes;
- PLATFORM, only where native FMUs are built for another platform than this one;
- FINDINGS, only where there are some: lines for the document.

`case.loaded()` is called when the tool has taken the FMU.
"""

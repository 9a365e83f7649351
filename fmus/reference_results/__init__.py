"""Reference results of the FMUs, computed when an FMU is built for a user.

`stimulus` defines a component's inputs, `results` computes the results by the monolithic solver, `files`
reads and writes inputs, results and options, and `inside` makes the files that an FMU ships. `compare` runs
an FMU against them.
"""

"""Reference results of the FMUs, in the layout of the FMI Cross-Check project.

`stimulus` defines a component's inputs, `reference` computes the results by the monolithic solver, `files`
reads and writes inputs, results and options, `layout` writes the project's folders, and `inside` adds them to
an FMU. `compare` runs an FMU against them, `exchange` does so in model exchange.
"""

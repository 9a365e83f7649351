"""Reference results of the FMUs, in the layout of the FMI Cross-Check project.

`stimulus` is what a component is put through, `reference` what the monolithic solver finds for it, `files`
reads and writes inputs, results and options, `layout` puts them where the project wants them, `inside`
into an FMU.
`compare` runs an FMU against them, in model exchange by `exchange`.
"""

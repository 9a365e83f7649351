"""Physics of valve trains and slider-cranks: components, systems and their monolithic reference.

The package has no FMI, files, plots or co-simulation masters. Imports inside the package are
relative, because the package is shipped inside every FMU under a name of its own.
"""

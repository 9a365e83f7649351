"""Work and precision: what every master, and other tools' masters, reach for how many doStep calls and how
much time, on one problem with the same FMU files. `benchmark.benchmark` runs it."""

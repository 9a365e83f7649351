"""Work and precision of masters: error over doStep calls and time, ours and other tools', with the same FMUs.

`benchmark.benchmark` runs it.
"""

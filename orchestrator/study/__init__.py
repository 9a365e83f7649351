"""Parameter studies: a scenario or an analysis at many points, in many processes, with one store."""

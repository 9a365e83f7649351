"""Parameter studies: any scenario or analysis at many points, on many processes, into one store."""

"""The line contact as a problem of its own: steady film, and the film over a cycle."""

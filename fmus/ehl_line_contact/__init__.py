"""FMU of the lubricated line contact with a solved pressure field."""

PYTHON_ONLY = "its pressure field needs Python; take the FMU in Python, or ehl_contact with a film formula"

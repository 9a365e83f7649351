"""Plain bearings by Reynolds' equation: fields of pressure, steady loads, small motions, and their table."""

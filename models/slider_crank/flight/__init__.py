"""Flights between impacts, impacts, chatter, sliding and tangent vectors, exact to rounding."""

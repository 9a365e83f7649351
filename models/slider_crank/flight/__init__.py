"""Flights, impacts, chatter and sliding at constant crank speed, exact to rounding."""

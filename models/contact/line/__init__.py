"""The line contact solved numerically: Reynolds' equation with cavitation on elastic half-planes."""

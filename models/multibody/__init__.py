"""Constrained multibody systems: bodies, joints and force elements; multipliers are the joints' loads."""

"""Components, systems of components and their integrators."""

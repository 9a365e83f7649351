"""A scenario over speed: its steady cycles, what an engineer asks of them, and the speed of separation."""

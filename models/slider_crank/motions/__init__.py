"""What motions are like: portraits, statistics, periods, chaos, maps over parameters."""

"""Parts of figures of one slider-crank motion: functions that draw plain arrays into given axes."""

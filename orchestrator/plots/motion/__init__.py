"""Parts of a figure of one slider-crank motion: functions that draw arrays into given axes."""

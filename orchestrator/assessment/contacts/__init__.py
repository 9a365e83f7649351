"""What lubricated contacts go through in a run: extremes, separation, impacts, limits left.

Everything is accumulated at every macro step, whatever is recorded.
"""

from .course import Course, Courses, courses_of_rows
from .lines import lines
from .observer import ContactObserver, with_angles

__all__ = ["ContactObserver", "Course", "Courses", "courses_of_rows", "lines", "with_angles"]

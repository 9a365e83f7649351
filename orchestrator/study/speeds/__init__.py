"""Speed sweep of a scenario: steady cycles, their figures of merit, and the separation speed."""

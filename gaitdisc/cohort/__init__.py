"""People that the package makes itself: the embedded cohort of twelve."""

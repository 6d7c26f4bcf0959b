"""Where two walks disagree over the stride, measured or simulated, and whether that is more than chance."""

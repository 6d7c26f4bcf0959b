"""From ground forces and segments in space to joint moments and powers: wrenches on feet, inertia, inverse dynamics."""

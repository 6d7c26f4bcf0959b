"""Find, name, add, show: where a simulation and measured data disagree, and the missing effect that explains it."""

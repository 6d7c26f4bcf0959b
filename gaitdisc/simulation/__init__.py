"""The simulation file: read, run, add an effect, write back."""

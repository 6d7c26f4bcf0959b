"""Pages a clinic reads: a person and session on each, and the index of a week."""

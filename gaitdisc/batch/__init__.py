"""Many participants: progress, resume, one run at a time in a folder."""

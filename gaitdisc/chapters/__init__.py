"""What chapter 3 and the fields of chapter 5 need and nothing else does; the studies read it, no command does."""

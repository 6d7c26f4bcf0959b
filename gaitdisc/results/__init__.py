"""Results: frozen, with provenance, saved and loaded; never plots, trains or logs."""

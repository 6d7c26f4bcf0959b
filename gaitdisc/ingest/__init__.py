"""Ingest: files of a gait laboratory become trials, converted once to the units used inside; identifiers stop here."""

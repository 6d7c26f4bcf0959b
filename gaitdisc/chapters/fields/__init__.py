"""Fields over time from a few sensors: their files, sensors that stand or travel, modes, errors."""

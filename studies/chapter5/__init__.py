"""Fields of chapter 5: their files, sensors that stand or travel, modes, errors, and a flow to sense."""

"""Regressions that stand beside the networks: each fits `Samples`, each is a `Model`."""

"""Chapter 4: Nominal, Exo, Discrepancy and Augmented for a participant (Eqs. 4.1-4.5)."""

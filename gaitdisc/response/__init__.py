"""Response (chapter 4): Nominal, Exo, Discrepancy and Augmented models of a participant (Eqs. 4.1-4.5).

Nouns: `ParticipantResponse`, `ResponseRun`, variants of both, and their pages.
Imports processing, models, report and what is below them.
"""

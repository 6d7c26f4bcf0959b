"""The clinic: reference, rules of what stands out, consistency, and a person's page and PDF.

Imports processing, report and what is below them.
"""

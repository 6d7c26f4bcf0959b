"""Reports: `Page`, `Block`, `Table`, `Figure`, panels, and the page of whatever was saved.

Lays out what it is handed and computes nothing. Imports saved results and what is below them.
"""

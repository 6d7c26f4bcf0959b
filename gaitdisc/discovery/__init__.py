"""Discovery: where a simulation and measured data disagree, the missing effect, and the page that shows it.

Nouns: `Case` (what a door hands in), `Criteria`, `Candidate`, `Discovery`. Doors: files, engine, tracked walk, device.
Imports engines, processing, report and what is below them.
"""

"""Reports: tables, figures and one self-contained page; reads results, never fits; the only home of matplotlib."""

"""`gaitdisc doctor`: whether this installation works, and what it lacks."""

from __future__ import annotations

import typer

from gaitdisc.commands.options import REFUSED


def doctor() -> None:
    """Check versions, fonts and browser, and test the readers with example files; nothing is changed."""
    import shutil

    from gaitdisc.report.panels import fonts_found
    from gaitdisc.run.installation import Check, checks

    found = list(checks())
    fonts = fonts_found()
    found.append(Check("fonts", "ok" if fonts else "wrong", ", ".join(fonts) or "no font for figures is installed"))
    browser = next(filter(None, map(shutil.which, ("chromium", "google-chrome", "firefox", "msedge"))), None)
    found.append(Check("browser", "ok" if browser else "absent", "found" if browser else "pages open in any browser"))
    for one in found:
        typer.echo(f"{one.state:7}{one.what:14}{one.words}")
    wrong = [one.what for one in found if one.state == "wrong"]
    if wrong:
        typer.echo(f"Not working: {', '.join(wrong)}. Install gaitdisc again in a separate environment.", err=True)
        raise typer.Exit(REFUSED)
    typer.echo("This installation works.")

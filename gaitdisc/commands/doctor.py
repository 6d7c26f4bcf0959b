"""`gaitdisc doctor`: whether this installation works, and what it lacks."""

import typer

from gaitdisc.commands.options import REFUSED


def doctor() -> None:
    """Check versions, fonts and browser, and test the readers with example files; nothing is changed."""
    import shutil

    from gaitdisc.report.panels import fonts_found
    from gaitdisc.run.installation import Check, checks

    results = list(checks())
    fonts = fonts_found()
    results.append(Check("fonts", "ok" if fonts else "wrong", ", ".join(fonts) or "no font for figures is installed"))
    browser = next(filter(None, map(shutil.which, ("chromium", "google-chrome", "firefox", "msedge"))), None)
    results.append(Check("browser", "ok" if browser else "absent", "found" if browser else "pages open in any browser"))
    for result in results:
        typer.echo(f"{result.state:7}{result.what:14}{result.words}")
    wrong = [result.what for result in results if result.state == "wrong"]
    if wrong:
        typer.echo(f"Not working: {', '.join(wrong)}. Install gaitdisc again in a separate environment.", err=True)
        raise typer.Exit(REFUSED)
    typer.echo("This installation works.")

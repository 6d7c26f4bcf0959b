"""`gaitdisc cite`: literature of the methods that a result used, as BibTeX."""

from pathlib import Path
from typing import Annotated

import typer


def cite(
    folder: Annotated[Path, typer.Argument(help="Folder of a result, or of a part of a chapter.")],
    out: Annotated[Path | None, typer.Option(help="File to write (.bib); by default the entries are printed.")] = None,
) -> None:
    """Print BibTeX entries of this program and of the methods used for the result in a folder."""
    from gaitdisc.run.citations import list_citations
    from gaitdisc.whole_file import write_whole

    cited = list_citations(folder)
    text = "\n\n".join(f"% {'; '.join(citation.methods)}\n{citation.entry}" for citation in cited) + "\n"
    if out is None:
        typer.echo(text, nl=False)
    else:
        typer.echo(f"{write_whole(out, text)}: {len(cited)} entries")

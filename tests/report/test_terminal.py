from rich.console import Console
from rich.table import Table

from gaitdisc.report.terminal import plain


def test_words_are_printed_letter_by_letter():
    console = Console(width=80, force_terminal=False)
    table = Table(caption=plain("[/c]"))
    table.add_column(plain("[b]h"))
    table.add_row(plain("xo[/b] :smile:"))
    with console.capture() as capture:
        console.print(table)
        console.print(plain("[exo]"))
    assert all(words in capture.get() for words in ("[b]h", "[/c]", "xo[/b] :smile:", "[exo]"))

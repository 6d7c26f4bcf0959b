"""Words on a terminal as they are: a condition that is called `[exo]` is no style, and `:walking:` no picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import rich.text


def plain(words: str, style: str = "") -> rich.text.Text:
    """Words that rich prints letter by letter, whatever they are; every cell and caption with a user's name is made so.

    >>> plain("xo[/b] :walking:").plain
    'xo[/b] :walking:'
    """
    from rich.text import Text

    return Text(words, style)

import pandas as pd

from gaitdisc.report.block import Block, save_block
from gaitdisc.report.table import Table


def test_a_block_lies_on_disk_as_it_is_shown(tmp_path):
    table = Table("sizes", "n = 1", ("a",), (("1",),), pd.DataFrame({"a": [1]}))
    saved = save_block(Block("here", "Heading", ("Said.",), (), (table,)), tmp_path)
    assert (saved.anchor, saved.heading, saved.sentences, saved.figures) == ("here", "Heading", ("Said.",), ())
    assert (tmp_path / "tables" / "sizes.csv").read_text() == "a\n1\n"

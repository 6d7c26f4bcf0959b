"""Tables and figures of the pages that the studies of the chapters write, and the parts that every page is made of."""

from gaitdisc.report.page import Block, write_blocks, write_markdown
from gaitdisc.report.table import Table, save_table
from gaitdisc.statistics.signed_rank import exact_p

__all__ = ["Block", "Table", "exact_p", "save_table", "write_blocks", "write_markdown"]

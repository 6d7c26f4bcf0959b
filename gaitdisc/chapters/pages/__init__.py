"""Tables and figures of the pages that the studies of the chapters write."""

"""R2, residuals over the stride, and what the filters give away for nothing."""

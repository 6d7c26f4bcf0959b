"""The clinic: reference, scores, rules of what stands out, consistency, before and after."""

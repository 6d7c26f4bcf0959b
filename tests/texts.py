"""What a text of the program says, beside its sentences: files, channels, numbers with their unit."""


def says(text: str, *parts: str) -> bool:
    """Whether all parts stand in a text, in this order; its sentences are approved in tests/approved.

    >>> says("walk.mot, knee_angle_r: 3 samples are missing.", "walk.mot", "knee_angle_r", "3 samples")
    True
    >>> says("3 samples of walk.mot are missing.", "walk.mot", "3 samples")
    False
    """
    start = 0
    for part in parts:
        found = text.find(part, start)
        if found < 0:
            return False
        start = found + len(part)
    return True

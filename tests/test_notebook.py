"""Short tables for notebooks, and the lines that a prompt shows."""

import numpy as np
from manufactured_discovery import manufactured
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording, Source, Strides, Trial
from gaitdisc.recording.strides import DroppedStride
from gaitdisc.words import as_html


def test_every_text_is_escaped():
    assert as_html("<b>", [("a & b", "<i>")]) == (
        "<table><caption>&lt;b&gt;</caption><tr><th>a &amp; b</th><td>&lt;i&gt;</td></tr></table>"
    )


def made(channels=2):
    values = np.arange(5.0)[:, None] * np.ones(channels)
    values[0] = np.nan
    names = tuple(Channel(f"c{k}", "signal", "V") for k in range(channels))
    return Recording(np.arange(5) / 100, values, names, "P01", "exo", Source("<walk>.csv"))


def test_a_recording_is_one_line_and_a_table_of_ranges():
    assert says(repr(made()), "Recording(2 channels (c0, c1)", "5 samples", "100 Hz)")
    page = made(14)._repr_html_()
    assert "<th>c0</th><td>1 to 4 [V]</td>" in page and "and 2 more" in page and "&lt;walk&gt;.csv" in page


def test_a_recording_without_samples_or_values_is_shown_too():
    channel = (Channel("a", "signal", "V"),)
    assert repr(Recording(np.empty(0), np.empty((0, 1)), channel)) == "Recording(1 channels (a), 0 samples)"
    assert "no value" in Recording(np.arange(2.0), np.full((2, 1), np.nan), channel)._repr_html_()


def test_strides_say_how_many_and_what_was_dropped():
    strides = Strides(np.array([0.0, 1.0]), np.array([1.0, 2.2]), "r", "force", (DroppedStride(2.2, 9.0, "too long"),))
    assert says(repr(strides), "Strides(2", "'r' by force", "0.00 to 2.20 s", "1 dropped)")
    assert "1.00 to 1.20 s" in strides._repr_html_() and "too long" in strides._repr_html_()
    assert says(repr(Strides(np.empty(0), np.empty(0), "l", "force")), "Strides(0", "'l' by force", "0 dropped)")


def test_a_trial_and_a_discovery_are_one_line():
    assert says(repr(Trial("walk", {"emg": made()})), "Trial('walk'", "emg 2", "100 Hz", "0 events, 0 findings)")
    found = manufactured()
    assert says(repr(found), "Discovery(missing_physics", "one-sided spring", "ankle_moment port.)")
    assert says(found._repr_html_(), "stiffness 286", "279 to 293", "N m/rad")

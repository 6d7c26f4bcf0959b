from gaitdisc.report.panels import MODELS, SIDES, WITHOUT_DEVICE


def test_models_and_sides_differ_without_colour():
    assert len({str(look.line) for look in MODELS.values()}) == len({look.mark for look in MODELS.values()}) == 3
    assert len({look.mark for look in SIDES.values()}) == 3
    assert WITHOUT_DEVICE.line != SIDES["l"].line


def test_left_is_red_right_is_blue():
    red, green, blue = (int(SIDES["l"].colour[i : i + 2], 16) for i in (1, 3, 5))
    assert red > 2 * max(green, blue)
    red, green, blue = (int(SIDES["r"].colour[i : i + 2], 16) for i in (1, 3, 5))
    assert blue > 2 * max(red, green)

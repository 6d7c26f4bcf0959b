from gaitdisc.commands.options import REFUSED, SOME_REFUSED, STOPPED


def test_each_exit_code_says_something_else():
    done, wrong_usage = 0, 2
    assert len({done, wrong_usage, REFUSED, SOME_REFUSED, STOPPED}) == 5

"""Commands that take long say what they are doing."""

import logging

import pytest

from studies import command_line, telling


def test_what_takes_long_is_told(monkeypatch, capsys):
    monkeypatch.setattr(telling, "QUIET", 0.0)
    with pytest.raises(SystemExit):
        command_line.main(["simulate", "loose_cable", "--t-end", "0.2", "--start", "straight", "--error", "0.1mm"])
    told = capsys.readouterr().err
    assert "anet-lumped: ... with dt=" in told and "again with dt=" in told and "which takes about" in told


def test_short_ones_do_not(capsys):
    with pytest.raises(SystemExit) as ended:
        command_line.main(["simulate", "loose_cable", "--t-end", "0.2", "--start", "straight", "--error", "0.1mm", "--json"])
    assert not ended.value.code
    assert "..." not in capsys.readouterr().err


def test_warnings_in_the_log_are_told_at_once(capsys):
    telling.tell_what_takes_long()
    logging.getLogger("integrators.kept_code").warning("Compiled code cannot be kept.")
    logging.getLogger("integrators").info("step 1 of 2")
    assert capsys.readouterr().err == "anet-lumped: warning: Compiled code cannot be kept.\n"

"""What a call may take: refused beyond the limit, which the environment sets."""

import pytest

from anet_lumped.checks import InputError
from anet_lumped.limits import ROWS, check_most


def test_within_the_limit_nothing_is_said():
    check_most(ROWS, ROWS.most, "A sweep")


@pytest.mark.parametrize("number", [1.001 * ROWS.most, float("inf"), float("nan"), 10**400])
def test_more_is_refused_with_the_number(number):
    with pytest.raises(
        InputError, match=r"A sweep would take \S+ rows, but must not take more than 1e\+06; .*ANET_LUMPED_MOST_ROWS"
    ):
        check_most(ROWS, number, "A sweep")


def test_the_environment_sets_another_limit(monkeypatch):
    monkeypatch.setenv(ROWS.variable, "1e7")
    check_most(ROWS, 1e7, "A sweep")
    monkeypatch.setenv(ROWS.variable, "10")
    with pytest.raises(InputError, match="11 rows"):
        check_most(ROWS, 11, "A sweep")


@pytest.mark.parametrize("word", ["many", "-1", "nan"])
def test_a_limit_that_is_no_number_is_refused(monkeypatch, word):
    monkeypatch.setenv(ROWS.variable, word)
    with pytest.raises(InputError, match="ANET_LUMPED_MOST_ROWS must be a positive number"):
        check_most(ROWS, 1, "A sweep")

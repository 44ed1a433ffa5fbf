"""How cases of hostile input end, and how none of them may."""

ACCEPTED, REFUSED, SAID = "accepted", "refused", "ended with a message"
TRACEBACK, HANG, LONG_LINE, OTHER_NUMBERS, NOT_A_NUMBER = (
    "traceback", "longer than 10 s", "long or strange line", "other numbers", "not a number",
)  # fmt: skip
BAD = (TRACEBACK, HANG, LONG_LINE, OTHER_NUMBERS, NOT_A_NUMBER)
OUTCOMES = (ACCEPTED, REFUSED, SAID, *BAD)
LONGEST_LINE, LONGEST_TIME = 300, 10.0  # characters; [s]

"""What a MoorDyn file has that is refused, and what is to be said of the rest.

All that is refused is told at once, each with its line. What is read and has no meaning here, and what may be read in two ways, is
told in one warning.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import groupby
from operator import itemgetter

from anet_lumped.checks import SceneError, one_line

SENTENCE = 270  # characters of a refusal, or of a sentence of the warning


class DeckError(SceneError):
    """A MoorDyn file that is refused. Its message has a line for each reason.

    Parameters
    ----------
    reasons : str
        One for each line of the message; they are the `args` of the error.
    """

    def __init__(self, *reasons: str) -> None:
        ValueError.__init__(self, *(one_line(reason) for reason in reasons))

    def __str__(self) -> str:
        return "\n".join(map(str, self.args))


class DeckWarning(UserWarning):
    """What a MoorDyn file says that has no meaning here, or another than it may seem. Its message has a line for each remark."""


class RowError(SceneError):
    """A row of a MoorDyn file that is refused.

    Parameters
    ----------
    source : name of the file
    line : number of its line
    text : what the row says
    why : why that does not do
    """

    def __init__(self, source: str, line: int, text: str, why: str) -> None:
        ValueError.__init__(self, source, line, text, why)

    def __str__(self) -> str:
        source, line, text, why = self.args
        return one_line(f'{source}, {_lines([line])}, "{text}": {why}')


class Findings:
    """Refusals and remarks that gather while a file is read.

    Parameters
    ----------
    source : str
        Name of the file, for messages.
    """

    def __init__(self, source: str) -> None:
        self.source = source
        self._refusals: list[tuple[int, str, str]] = []  # line, row, reason
        self._whole: list[str] = []  # reasons that no line has
        self._remarks: dict[str, None] = {}  # each once, in order
        self._unused: dict[str, list[str]] = {}

    @contextmanager
    def refusing(self) -> Iterator[None]:
        """Gather an error that is raised within, instead of letting it out."""
        try:
            yield
        except RowError as error:
            _, line, text, why = error.args
            self._refusals.append((line, text, why))
        except SceneError as error:
            self._whole.append(str(error))

    def remark(self, sentence: str) -> None:
        """Say something in the warning."""
        self._remarks[one_line(sentence, SENTENCE)] = None

    def unused(self, what: str, line: int, kind: str) -> None:
        """Say that something on a line has no meaning here; things of one kind are listed together."""
        self._unused.setdefault(kind, []).append(f"{what} (line {line})")

    @property
    def any_refused(self) -> bool:
        """Whether anything is refused."""
        return bool(self._refusals or self._whole)

    def raise_if_refused(self) -> None:
        """Raise `DeckError` with all that is refused, if anything is; rows that are refused for one reason are told together."""
        if not self.any_refused:
            return
        told: list[tuple[int, str]] = []
        by_reason = sorted(self._refusals, key=itemgetter(2, 0))
        for why, same in groupby(by_reason, key=itemgetter(2)):
            rows = list(same)
            lines = _lines([line for line, _, _ in rows])
            told.append((rows[0][0], f'{self.source}, {lines}, "{rows[0][1]}": {why}'))
        raise DeckError(*self._whole, *(text for _, text in sorted(told)))

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences of the warning."""
        lists = (text for kind, found in self._unused.items() for text in _sentences(f"No use is made of {kind}: ", found))
        return (*lists, *self._remarks)


def _sentences(start: str, things: list[str]) -> Iterator[str]:
    """Yield sentences of bounded length that list all of some things."""
    listed = ""
    for thing in things:
        if listed and len(start) + len(listed) + len(thing) > SENTENCE - 3:
            yield one_line(f"{start}{listed}.", SENTENCE)
            listed = ""
        listed += f", {thing}" if listed else thing
    yield one_line(f"{start}{listed}.", SENTENCE)


def _lines(numbers: list[int]) -> str:
    """Return "line 7", "lines 7 to 9" or "lines 7, 9"; 0 stands for what no line says."""
    if numbers == [0]:
        return "OPTIONS"
    if len(numbers) == 1:
        return f"line {numbers[0]}"
    if len(numbers) > 2 and numbers[-1] - numbers[0] == len(numbers) - 1:
        return f"lines {numbers[0]} to {numbers[-1]}"
    return f"lines {', '.join(map(str, numbers))}"

"""A source of chance for random trials: hypothesis, which makes what fails small."""

from hypothesis import strategies as st


class Drawn:
    """`Pick` from hypothesis."""

    def __init__(self, data):
        self.data = data

    def integer(self, low, high):
        return self.data.draw(st.integers(low, high))

    def number(self, low, high):
        return self.data.draw(st.floats(low, high))

    def one_of(self, choices):
        return self.data.draw(st.sampled_from(choices))

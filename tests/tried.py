"""How many examples hypothesis tries of a property: a quarter by default, all of them where the slow tests run."""

from hypothesis import settings

all_of_them = False  # set before files of tests are imported


def tried(examples: int = 100, **options) -> settings:
    """Settings with so many examples among the slow tests, a quarter of them by default, and no limit of time."""
    return settings(deadline=None, max_examples=examples if all_of_them else max(examples // 4, 10), **options)

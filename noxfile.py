"""The same checks on every version of Python that is installed here: `nox`, or one of them, as in `nox -s tests-3.12`."""

import nox

nox.options.sessions = ["style", "tests"]
nox.options.error_on_missing_interpreters = False
VERSIONS = ["3.11", "3.12", "3.13"]


@nox.session
def style(session):
    """Check style, types, and who imports whom."""
    session.install("ruff", "import-linter", "mypy", "numpy", "pydantic")
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")
    session.run("mypy")
    session.run("lint-imports")


@nox.session(python=VERSIONS)
def tests(session):
    """Run the tests as the README says."""
    session.install(".[test]")
    session.run("pytest", *session.posargs)


@nox.session(python=VERSIONS)
def packages(session):
    """Build the wheel and the source archive, and run the wheel."""
    session.install("build", "twine")
    session.run("bash", ".ci/packages", external=True)


@nox.session
def docs(session):
    """Build the pages."""
    session.install(".[docs]")
    session.run("sphinx-build", "-W", "--keep-going", "docs", "build/site")
